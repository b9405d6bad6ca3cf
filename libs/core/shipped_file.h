#pragma once

#include <filesystem>

namespace fathom {

/// Where a file is that ships with the program (config/TL5.yaml, maps/dexrov/panel.yaml): `file` as it is
/// where there is one; else where the program was installed to (../share/fathom beside its folder), in the
/// folder fathom of one of XDG_DATA_DIRS (/usr/local/share, /usr/share), in the source folder. As it is, too,
/// where it is in none of these: whoever reads it will complain of that.
std::filesystem::path shippedFile(const std::filesystem::path& file);

}  // namespace fathom
