// Tables of when frames were taken: in which form, and what is wrong with them.
#include "video/frame_stamps.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "recording/time_text.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

StampTable tableOf(const std::string& text) {
  const auto file = test::scratchFolder() / "stamps.csv";
  writeTextFile(file, text);
  return readFrameStamps(file);
}

std::string stampComplaint(const std::string& text) {
  try {
    tableOf(text);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

void expectStampComplaint(const std::string& text, const std::string& line, const std::string& why) {
  const std::string complaint = stampComplaint(text);
  EXPECT_NE(complaint.find("stamps.csv: " + line + ": "), std::string::npos) << text << complaint;
  EXPECT_NE(complaint.find(why), std::string::npos) << text << complaint;
}

/// 2024-05-06 07:08:09 UTC, by `date -u -d 2024-05-06T07:08:09 +%s`.
constexpr std::int64_t kSecond = 1714979289;

std::vector<std::int64_t> ticksOf(const StampTable& table) {
  std::vector<std::int64_t> ticks;
  for (const FrameStamp& stamp : table.stamps) ticks.push_back(unixTicks(stamp.time) - kSecond * 10'000'000);
  return ticks;
}

TEST(FrameStamps, FormIsFoundByValues) {
  const std::vector<std::int64_t> expected{0, 1'234'567};  // exact to the tick: nothing goes through a double
  EXPECT_EQ(ticksOf(tableOf("1714979289\n1714979289.1234567\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("1.714979289e9\n1.7149792891234567e+09\n")), expected) << "as numpy writes them";
  EXPECT_EQ(ticksOf(tableOf("1714979289000\n1714979289123.4567\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("1714979289000000\n1714979289123456.7\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("1714979289000000000\n1714979289123456700\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("1714979289000000000\n1714979289123456749\n")), expected) << "rounded";
  EXPECT_EQ(ticksOf(tableOf("2024-05-06T07:08:09Z\n2024-05-06T07:08:09.1234567Z\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("2024-05-06 07:08:09\n2024-05-06 07:08:09.12345674\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("20240506T070809Z\n20240506T070809.1234567Z\n")), expected);
  EXPECT_EQ(ticksOf(tableOf("2024-05-06T09:08:09+02:00\n2024-05-06T01:38:09.12345665-0530\n")), expected);
}

TEST(FrameStamps, SaysWhatWasConcluded) {
  EXPECT_EQ(tableOf("1714979289\n").remarks,
            std::vector<std::string>{"the stamps are Unix time in seconds, by their size"});
  EXPECT_EQ(tableOf("1714979289000000000\n").remarks,
            std::vector<std::string>{"the stamps are Unix time in nanoseconds, by their size"});
  EXPECT_EQ(tableOf("2024-05-06T07:08:09\n").remarks,
            std::vector<std::string>{"the stamps are ISO 8601, taken for UTC: they name no zone"});
  EXPECT_EQ(
      tableOf("1,2024-05-06T07:08:09Z\n").remarks,
      (std::vector<std::string>{"the stamps are ISO 8601", "frames are counted from 1, by the first row"}));
}

TEST(FrameStamps, ColumnsMayBeNamedOrNot) {
  for (const char* header : {"", "stamp\n", "timestamp [s]\n", "# time\n"}) {
    const StampTable table = tableOf(header + std::string("1714979289\n1714979290\n1714979291\n"));
    EXPECT_FALSE(table.names_frames);
    ASSERT_EQ(table.stamps.size(), 3U) << header;
    EXPECT_EQ(table.stamps[2].frame, 2);
    EXPECT_EQ(table.stamps[2].line, *header == '\0' ? 3U : 4U);
  }
  for (const char* text : {"frame,stamp\n4,1714979289\n7,1714979290\n", "4, 1714979289\n7, 1714979290\r\n",
                           "\"stamp\",\"Frame_number\"\n1714979289,4\n1714979290,7\n"}) {
    const StampTable table = tableOf(text);
    EXPECT_TRUE(table.names_frames);
    ASSERT_EQ(table.stamps.size(), 2U) << text;
    EXPECT_EQ(table.stamps[0].frame, 4);
    EXPECT_EQ(table.stamps[1].frame, 7);
    EXPECT_EQ(ticksOf(table), (std::vector<std::int64_t>{0, 10'000'000}));
  }
  const StampTable from_one = tableOf("1,1714979289\n2,1714979290\n");
  EXPECT_EQ(from_one.stamps[0].frame, 0);
  EXPECT_EQ(from_one.stamps[1].frame, 1);
}

TEST(FrameStamps, WrongTablesAreOneLine) {
  expectStampComplaint("", "line 1", "empty");
  expectStampComplaint("stamp\n", "line 2", "no rows");
  expectStampComplaint("1714979289\n1714979290\n1714979290\n", "line 3", "that of the row before again");
  expectStampComplaint("stamp\n1714979289\n1714979290.5\n1714979290.25\n", "line 4", "steps back by 0.25 s");
  expectStampComplaint("0,1714979289\n0,1714979290\n", "line 2", "not above");
  expectStampComplaint("5,1714979289\n4,1714979290\n", "line 2", "not above");
  expectStampComplaint("-1,1714979289\n", "line 1", "whole number");
  expectStampComplaint("0.5,1714979289\n", "line 1", "whole number");
  expectStampComplaint("0.04\n0.08\n", "line 1", "no Unix time from 1990 to 2100");
  expectStampComplaint("stamp\nsoon\n", "line 2", "neither");
  expectStampComplaint("stamp\n1714979289\nnan\n", "line 3", "neither");
  expectStampComplaint("1714979289\n1714979290000\n", "line 2", "another form");
  expectStampComplaint("1714979289\n2024-05-06T07:08:10Z\n", "line 2", "another form");
  expectStampComplaint("2024-05-06T07:08:09Z\n1714979290\n", "line 2", "another form");
  expectStampComplaint("2024-05-06T07:08:09Z\n2024-05-06T07:08:10\n", "line 2", "another form");
  expectStampComplaint("1714979289\n\n", "line 2", "neither");
  expectStampComplaint("0,1714979289\n1714979290\n", "line 2", "1 fields instead of 2");
  expectStampComplaint("0,1714979289,1\n", "line 1", "must have a stamp");
  expectStampComplaint("stamp,exposure\n1714979289,1\n", "line 1", "must have a stamp");
}

TEST(FrameStamps, IsoIsStrict) {
  for (const char* text :
       {"2024-02-30T00:00:00Z", "2024-13-01T00:00:00Z", "2024-05-06T24:00:00Z", "2024-05-06T07:60:00Z",
        "2024-05-06T07:08:61Z", "2024-05-06", "2024-05-06T07:08", "2024-05-06T07:08:09.Z",
        "2024-05-06T07:08:09Zulu", "2024-05-06T07:08:09+", "2024-05-06T07:08:09+25:00", "2024-0506T07:08:09Z",
        "2024-05-06T07:0809Z", "24-05-06T07:08:09Z", "", "T"})
    EXPECT_FALSE(readIsoStamp(text)) << text;
  EXPECT_TRUE(readIsoStamp("2024-02-29T23:59:59.999999999+14:00"));
  // The last one that there was.
  EXPECT_EQ(readIsoStamp("2016-12-31T23:59:60Z").value().time,
            readIsoStamp("2017-01-01T00:00:00Z").value().time);
}

// 25 a second but for a pause of five intervals, in which four frames are missing, and one of two.
TEST(FrameStamps, PaceSaysWhatIsMissing) {
  std::vector<FrameStamp> stamps;
  double t_s = 0;
  for (int k = 0; k < 100; ++k) {
    stamps.push_back({k, after(fromUnixSeconds(kSecond), t_s), 0});
    t_s += k == 30 ? 0.2 : k == 60 ? 0.08 : 0.04;
  }
  const auto even = describePace(stamps, 25);
  ASSERT_EQ(even.size(), 2U);
  EXPECT_NE(even[0].find("a frame each 0.04 s (25 a second"), std::string::npos) << even[0];
  EXPECT_NE(even[0].find("longest 0.2 s"), std::string::npos) << even[0];
  EXPECT_NE(even[1].find("2 intervals"), std::string::npos) << even[1];
  EXPECT_NE(even[1].find("about 5 frames"), std::string::npos) << even[1];
  const auto other = describePace(stamps, 30);
  ASSERT_EQ(other.size(), 3U);
  EXPECT_NE(other[2].find("header says 30 frames a second, its stamps 25"), std::string::npos) << other[2];
  // Frames whose row is missing are in the video: nothing was dropped.
  std::erase_if(stamps, [](const FrameStamp& s) { return s.frame > 25; });
  std::erase_if(stamps, [](const FrameStamp& s) { return s.frame % 3 == 1; });
  EXPECT_EQ(describePace(stamps, 0).size(), 1U);
  EXPECT_TRUE(describePace({stamps[0]}, 25).empty());
}

}  // namespace
}  // namespace fathom
