#include "recording/export_csv.h"

#include <cmath>
#include <fstream>
#include <map>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "recording/fields.h"
#include "recording/recording_info.h"
#include "recording/time_text.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

std::string fileName(const std::string& label) {
  std::string name;
  for (const char c : label) {
    const auto byte = static_cast<unsigned char>(c);
    char code[4];
    std::snprintf(code, sizeof code, "%%%02X", byte);
    const bool plain = std::isalnum(byte) || c == '_' || c == '-' || (c == '.' && !name.empty());
    name += plain ? std::string(1, c) : code;
  }
  return name + ".csv";
}

std::string numberText(const std::optional<double>& value) {
  if (!value || std::isnan(*value)) return "NaN";
  return shortest(*value);
}

/// RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

class Table {
 public:
  Table(const fs::path& file, const Reading& first) : file_(file), out_(file_.path(), std::ios::binary) {
    out_ << "time_unix_s,time_s";
    const auto names = fieldNames(first);
    for (const std::string& name : names) out_ << ',' << name;
    const auto images = imageFiles(first).size();
    if (images == 1) out_ << ",file";
    if (images == 2) out_ << ",left_file,right_file";
    out_ << '\n';
    columns_ = names.size();
  }

  void add(const Sample& sample, Time start) {
    fieldValues(sample.reading, values_);
    const std::size_t rows = fieldRows(sample.reading);
    if (values_.size() != rows * columns_)
      throw Error(file_.target().string(), "",
                  "label " + sample.label + " has " + std::to_string(values_.size()) + " values at " +
                      secondsText(unixTicks(sample.time)) + " s, had " + std::to_string(columns_) +
                      " before");
    for (std::size_t row = 0; row < rows; ++row) {
      out_ << secondsText(unixTicks(sample.time)) << ',' << secondsText((sample.time - start).count());
      for (std::size_t column = 0; column < columns_; ++column)
        out_ << ',' << numberText(values_[row * columns_ + column]);
      for (const std::string& image : imageFiles(sample.reading)) out_ << ',' << quoted(image);
      out_ << '\n';
    }
  }

  fs::path commit() {
    out_.close();
    if (!out_) throw Error(file_.target().string(), "", "cannot be written");
    file_.commit();
    return file_.target();
  }

 private:
  PendingFile file_;
  std::ofstream out_;
  std::size_t columns_ = 0;
  std::vector<std::optional<double>> values_;
};

std::string labelAndKind(const Sample& sample) {
  const std::string kind = kindOf(sample.reading);
  return printable(sample.label.empty() ? kind : sample.label + ", " + kind);
}

}  // namespace

CsvExport exportCsv(const fs::path& rawlog, const fs::path& folder,
                    const std::function<void(double)>& progress) {
  RawlogReader reader(rawlog);
  CsvExport result;
  std::map<std::string, Table> tables;
  std::optional<Time> start;
  std::uint64_t entries = 0;
  while (const auto sample = reader.next()) {
    if (!start) start = sample->time;
    if (progress && ++entries % kEntriesPerProgress == 0) progress(reader.fraction());
    if (std::holds_alternative<RecordingHeader>(sample->reading)) continue;
    if (std::holds_alternative<UnknownSample>(sample->reading)) {
      ++result.left_out[labelAndKind(*sample)];
      continue;
    }
    const auto table =
        tables.try_emplace(sample->label, folder / fileName(sample->label), sample->reading).first;
    table->second.add(*sample, *start);
  }
  for (auto& [label, table] : tables) result.files.push_back(table.commit());
  result.loss = reader.loss();
  return result;
}

}  // namespace fathom
