#pragma once

#include <string>
#include <vector>

#include "ros_bag/bag_message.h"

/// Images of a bag's messages as bytes of image files.
namespace fathom {

/// A raw image as PNG, gray (of 8 or 16 bits) or colour; Bayer patterns and YUV are made colour, alpha is
/// left out. Throws BadMessage: an encoding that is not known (the message lists those that are); data that
/// does not fit width, height and step.
std::vector<unsigned char> encodePng(const ros1::Image& image, const BagMessage& message);

/// 16 or 8, of the PNG.
int bitsOf(const std::string& encoding);

/// ".png" or ".jpg", by the bytes that a compressed image begins with. Throws Error, about the message, where
/// it is neither.
std::string compressedExtension(const std::vector<unsigned char>& bytes, const BagMessage& message);

}  // namespace fathom
