#pragma once

#include <string>
#include <vector>

#include "ros_bag/bag_message.h"

/// Images of a bag's messages as bytes of image files.
namespace fathom {

/// A raw image as PNG, gray or colour; Bayer patterns are made colour. Throws Error, about the message: an
/// encoding other than mono8, bgr8, rgb8 and bayer_*8; data that does not fit width, height and step.
std::vector<unsigned char> encodePng(const ros1::Image& image, const BagMessage& message);

/// ".png" or ".jpg", by the bytes that a compressed image begins with. Throws Error, about the message, where
/// it is neither.
std::string compressedExtension(const std::vector<unsigned char>& bytes, const BagMessage& message);

}  // namespace fathom
