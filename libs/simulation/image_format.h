#pragma once

namespace fathom {

/// How simulated images are stored.
struct ImageFormat {
  enum class Kind { png, jpeg } kind = Kind::png;
  int jpeg_quality = 90;  ///< 1 to 100, libjpeg's

  const char* extension() const { return kind == Kind::png ? ".png" : ".jpg"; }
};

}  // namespace fathom
