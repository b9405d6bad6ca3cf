#include "ros_bag/bag_check.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "core/error.h"

namespace fathom {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
// rosbag writes chunks of 768 kB, or of one large message. A compressed one can claim any length, and a
// sparse file can have it.
constexpr std::uint32_t kLargestRecord = 256U << 20U;

enum Op : unsigned char {
  message = 2,
  bag_header = 3,
  index_data = 4,
  chunk = 5,
  chunk_info = 6,
  connection = 7
};

using Fields = std::map<std::string, std::string, std::less<>>;

/// Where a record starts, for errors; its reason is what() of the Error thrown.
class BagChecker {
 public:
  explicit BagChecker(const std::filesystem::path& file)
      : name_(file.string()), in_(file, std::ios::binary), size_(std::filesystem::file_size(file)) {}

  void run() {
    if (read(std::min<std::uint64_t>(kMagic.size(), size_)) != kMagic)
      throw Error(name_, "", "is not a ROS 1 bag of version 2.0");
    while (position_ < size_) checkRecord();
    starts_.insert(size_);  // an empty bag has an empty index
    if (!starts_.contains(index_position_) || chunk_count_ != chunks_.size() || chunks_ != referred_chunks_)
      throw Error(name_, "", "its index does not fit its contents: cut off, damaged, or never closed");
  }

 private:
  void checkRecord() {
    record_ = position_;
    starts_.insert(record_);
    const Fields fields = parse(read(length()));
    const std::string data = read(length());
    switch (op(fields)) {
      case bag_header:
        index_position_ = number<std::uint64_t>(fields, "index_pos");
        chunk_count_ = number<std::uint32_t>(fields, "chunk_count");
        break;
      case chunk:
        checkChunk(fields, data);
        break;
      case index_data:
        checkIndex(fields, data);
        break;
      case chunk_info:
        referred_chunks_.insert(number<std::uint64_t>(fields, "chunk_pos"));
        expectEntries(fields, data, 8);
        break;
      case connection:
        parse(data);
        break;
      case message:
        break;
      default:
        throw error("has a record of unknown kind");
    }
  }

  void checkChunk(const Fields& fields, const std::string& data) {
    chunks_.insert(record_);
    messages_.clear();
    const std::string inside =
        decompress(text(fields, "compression"), data, number<std::uint32_t>(fields, "size"));
    for (std::size_t at = 0; at < inside.size();) {
      const std::size_t start = at;
      const Fields inner = parse(piece(inside, at));
      const std::string_view body = piece(inside, at);
      const unsigned char kind = op(inner);
      if (kind == message)
        messages_.insert(start);
      else if (kind == connection)
        checkConnection(inner, body);
      else
        throw error("a chunk holds a record of unknown kind");
    }
  }

  void checkConnection(const Fields& fields, std::string_view data) const {
    number<std::uint32_t>(fields, "conn");
    text(fields, "topic");
    const Fields described = parse(data);
    for (const char* name : {"type", "md5sum", "message_definition"}) text(described, name);
  }

  /// Entries of time (8 bytes) and offset in the chunk before.
  void checkIndex(const Fields& fields, const std::string& data) {
    expectEntries(fields, data, 12);
    for (std::size_t at = 8; at + 4 <= data.size(); at += 12) {
      std::uint32_t offset = 0;
      std::memcpy(&offset, data.data() + at, 4);
      if (!messages_.contains(offset)) throw error("the index refers to a message that is not there");
    }
  }

  void expectEntries(const Fields& fields, const std::string& data, std::size_t entry_bytes) const {
    if (data.size() != number<std::uint32_t>(fields, "count") * entry_bytes)
      throw error("an index has another length than it says");
  }

  std::string decompress(const std::string& compression, std::string data, std::uint32_t size) const {
    if (compression == "none") {
      if (data.size() != size) throw error("a chunk has another length than it says");
      return data;
    }
    if (size > kLargestRecord) throw error("a chunk's length is absurd");
    std::string inside(size, '\0');
    unsigned int decompressed = size;
    bool good = false;
    if (compression == "bz2")
      good = BZ2_bzBuffToBuffDecompress(inside.data(), &decompressed, data.data(),
                                        static_cast<unsigned int>(data.size()), 0, 0) == BZ_OK;
    else if (compression == "lz4")
      good = roslz4_buffToBuffDecompress(data.data(), static_cast<unsigned int>(data.size()), inside.data(),
                                         &decompressed) == ROSLZ4_OK;
    else
      throw error("a chunk's compression is not known");
    if (!good || decompressed != size) throw error("a chunk cannot be decompressed");
    return inside;
  }

  // ---- bytes ----

  /// A length and that many bytes.
  std::string_view piece(const std::string& bytes, std::size_t& at) const {
    std::uint32_t length = 0;
    if (bytes.size() - at < 4) throw error("a chunk ends within a record");
    std::memcpy(&length, bytes.data() + at, 4);
    at += 4;
    if (bytes.size() - at < length) throw error("a chunk ends within a record");
    at += length;
    return {bytes.data() + at - length, length};
  }

  /// Header fields: each a length and name=value.
  Fields parse(std::string_view header) const {
    Fields fields;
    while (!header.empty()) {
      std::uint32_t length = 0;
      if (header.size() < 4) throw error("a header is damaged");
      std::memcpy(&length, header.data(), 4);
      header.remove_prefix(4);
      const auto equals = header.substr(0, length).find('=');
      if (length > header.size() || equals == std::string_view::npos) throw error("a header is damaged");
      fields[std::string(header.substr(0, equals))] = header.substr(equals + 1, length - equals - 1);
      header.remove_prefix(length);
    }
    return fields;
  }

  std::string text(const Fields& fields, std::string_view name) const {
    const auto field = fields.find(name);
    if (field == fields.end()) throw error("a header lacks `" + std::string(name) + "`");
    return field->second;
  }
  template <class T>
  T number(const Fields& fields, std::string_view name) const {
    const std::string bytes = text(fields, name);
    T value = 0;
    if (bytes.size() != sizeof value) throw error("`" + std::string(name) + "` in a header is damaged");
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  unsigned char op(const Fields& fields) const { return number<unsigned char>(fields, "op"); }

  std::uint32_t length() {
    std::uint32_t value = 0;
    std::memcpy(&value, read(4).data(), 4);
    return value;
  }
  std::string read(std::uint64_t bytes) {
    if (bytes > size_ - position_) throw error("the file ends within a record: cut off or damaged");
    if (bytes > kLargestRecord) throw error("a record's length is absurd");
    std::string data(bytes, '\0');
    in_.read(data.data(), static_cast<std::streamsize>(bytes));
    if (!in_) throw Error(name_, "", "cannot be read");
    position_ += bytes;
    return data;
  }
  Error error(const std::string& why) const { return {name_, "byte " + std::to_string(record_), why}; }

  std::string name_;
  std::ifstream in_;
  std::uint64_t size_;
  std::uint64_t position_ = 0, record_ = 0, index_position_ = 0;
  std::size_t chunk_count_ = 0;
  std::set<std::uint64_t> starts_, chunks_, referred_chunks_;
  std::set<std::size_t> messages_;  // offsets in the last chunk
};

}  // namespace

void checkBag(const std::filesystem::path& file) { BagChecker(file).run(); }

}  // namespace fathom
