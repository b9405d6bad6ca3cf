#include "core/yaml.h"

#include <gtest/gtest.h>

#include "core/files.h"
#include "core/text.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

/// What a call throws; fails the test where it throws nothing.
template <class F>
Error yamlErrorOf(F&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing thrown";
  return {"", "", ""};
}

Error errorIn(const std::string& text, const std::function<void(const YamlMap&)>& read = {}) {
  return yamlErrorOf([&] {
    const YamlFile yaml = YamlFile::parse(text, "some.yaml");
    if (read) read(yaml.root());
    yaml.rejectUnknownKeys();
  });
}

TEST(Yaml, ReadsEveryKind) {
  const YamlFile yaml = YamlFile::parse(R"(
number: -1.5e-3
plus: +2
whole: 12
flag: true
text: hello world
list: [1, 2.5, -3]
words: [a, b]
place: [1, 2, 3]
inner: {deep: {value: 7}}
entries:
  - {id: 1}
  - {id: 2}
pose: {x: 1, y: 2, z: 3, yaw_deg: 90, pitch_deg: 0, roll_deg: 0}
)",
                                        "some.yaml");
  const YamlMap& y = yaml.root();
  EXPECT_EQ(y.number("number"), -1.5e-3);
  EXPECT_EQ(y.number("plus"), 2.0);
  EXPECT_EQ(y.integer("whole"), 12);
  EXPECT_TRUE(y.flag("flag"));
  EXPECT_EQ(y.text("text"), "hello world");
  EXPECT_EQ(y.numbers("list"), (std::vector<double>{1, 2.5, -3}));
  EXPECT_EQ(y.texts("words"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(y.vector3("place"), Vector3d(1, 2, 3));
  EXPECT_EQ(y.map("inner").map("deep").number("value"), 7);
  EXPECT_EQ(y.maps("entries").at(1).integer("id"), 2);
  EXPECT_EQ(y.maps("entries").at(0).integer("id"), 1);
  const Pose pose = y.pose("pose");
  EXPECT_LT((pose * Vector3d(1, 0, 0) - Vector3d(1, 3, 3)).norm(), 1e-15);
  EXPECT_FALSE(y.has("absent"));
  EXPECT_NO_THROW(yaml.rejectUnknownKeys());
}

TEST(Yaml, OptionsKeepTheirDefaultWhereTheKeyIsAbsent) {
  const YamlFile yaml = YamlFile::parse("given: 2\n", "some.yaml");
  double given = 1, absent = 1;
  yaml.root().read("given", given);
  yaml.root().read("absent", absent);
  EXPECT_EQ(given, 2);
  EXPECT_EQ(absent, 1);
}

TEST(Yaml, UnknownKeyNamesTheNearest) {
  const Error error = errorIn("outer:\n  rate_hz: 1\n  sgima_m: 2\n", [](const YamlMap& y) {
    y.map("outer").number("rate_hz");
    (void)y.map("outer").has("sigma_m");
  });
  EXPECT_EQ(error.file, "some.yaml");
  EXPECT_EQ(error.where, "outer.sgima_m (line 3)");
  EXPECT_EQ(error.why, "unknown key; did you mean `sigma_m`?");
}

TEST(Yaml, UnknownKeyInAListOfMaps) {
  const Error error = errorIn("list:\n  - {id: 1}\n  - {id: 2, name: x}\n", [](const YamlMap& y) {
    for (const YamlMap& entry : y.maps("list")) entry.integer("id");
  });
  EXPECT_EQ(error.where, "list[1].name (line 3)");
}

TEST(Yaml, MissingKeyNamesItsMap) {
  const Error error = errorIn("a: 1\nouter:\n  b: 2\n", [](const YamlMap& y) {
    y.number("a");
    y.map("outer").number("rate_hz");
  });
  EXPECT_EQ(error.where, "outer (line 3)");
  EXPECT_EQ(error.why, "missing key `rate_hz`");
}

TEST(Yaml, MissingKeyIsTakenForOneThatIsMisspelt) {
  const Error error = errorIn("scale_eror: 1\n", [](const YamlMap& y) { y.number("scale_error"); });
  EXPECT_EQ(error.why, "missing key `scale_error`; is `scale_eror` meant for it?");
}

TEST(Yaml, KeyWithoutItsUnitIsToldSo) {
  const Error error = errorIn("a: 1\nrate: 5\n", [](const YamlMap& y) {
    y.number("a");
    y.number("rate_hz");
  });
  EXPECT_EQ(error.where, "rate (line 2)");
  EXPECT_EQ(error.why, "lacks its unit; did you mean `rate_hz`?");
}

TEST(Yaml, DuplicateKeyAtAnyDepth) {
  EXPECT_EQ(errorIn("a: 1\nb: 2\na: 3\n").where, "a (line 3)");
  EXPECT_EQ(errorIn("a:\n  b: 1\n  b: 1\n").where, "a.b (line 3)");
  EXPECT_EQ(errorIn("a:\n  - {b: 1}\n  - {b: 1, b: 2}\n").where, "a[1].b (line 3)");
  EXPECT_EQ(errorIn("a: 1\na: 3\n").why, "duplicate key");
}

TEST(Yaml, BrokenSyntaxNamesTheLine) {
  const Error open = errorIn("a: 1\nb: [1, 2\n");
  EXPECT_EQ(open.file, "some.yaml");
  EXPECT_EQ(open.where.rfind("line ", 0), 0U) << open.where;
  EXPECT_EQ(open.why.rfind("not YAML", 0), 0U) << open.why;
  errorIn("a: {b: 1\n");
  errorIn("a: \"b\n");
  errorIn("a: b: c\n");
  errorIn("a: *nowhere\n");
}

TEST(Yaml, WhatIsQuotedOfAFileStaysInOneLine) {
  const std::string unknown_escape = errorIn("a: \"\\\x1b\"\n").what();
  EXPECT_NE(unknown_escape.find("not YAML"), std::string::npos) << unknown_escape;
  EXPECT_EQ(unknown_escape.find('\x1b'), std::string::npos) << unknown_escape;
  const std::string unknown_key = errorIn("\"a\\e[2Jb\": 1\n").what();
  EXPECT_EQ(unknown_key.find('\x1b'), std::string::npos) << unknown_key;
  EXPECT_NE(unknown_key.find("a [2Jb"), std::string::npos) << unknown_key;
}

TEST(Yaml, RootMustBeOneMap) {
  errorIn("");
  errorIn("- 1\n- 2\n");
  errorIn("42\n");
  EXPECT_EQ(errorIn("a: 1\n---\nb: 2\n").why, "not YAML, or more than one document");
  // Of which yaml-cpp would make documents until memory is full.
  EXPECT_EQ(errorIn(", a: 1\n").why, "not YAML, or more than one document");
  EXPECT_EQ(errorIn("[a, b]: 1\n").why, "a key must be a plain word");
}

TEST(Yaml, AliasesCannotBlowUp) {
  errorIn("a: &x {b: *x}\n");
  errorIn("a: &x [*x]\n");
  std::string laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string before = print("*a%d", i - 1);
    laughs += print("a%d: &a%d [", i, i) + before;
    for (int j = 0; j < 9; ++j) laughs.append(", ").append(before);
    laughs += "]\n";
  }
  errorIn(laughs);
  errorIn("a: " + std::string(100, '[') + std::string(100, ']'));
}

TEST(Yaml, AMatrixIsAListOrOneOfRows) {
  const YamlFile yaml = YamlFile::parse(
      "rows: [[1, 2, 3], [4, 5, 6]]\nlist: [1, 2]\nuneven: [[1, 2], [3]]\n"
      "mixed: [[1, 2], 3]\nempty: []\nnothing:\nno_text: ''\n",
      "some.yaml");
  const YamlMap& y = yaml.root();
  EXPECT_EQ(y.matrix("rows"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(y.matrix("list"), (std::vector<double>{1, 2}));
  EXPECT_TRUE(y.matrix("empty").empty());
  EXPECT_THROW(y.matrix("uneven"), Error);
  EXPECT_THROW(y.matrix("mixed"), Error);
  EXPECT_TRUE(y.isEmpty("nothing") && y.isEmpty("no_text"));
  EXPECT_FALSE(y.isEmpty("empty") || y.isEmpty("absent"));
}

TEST(Yaml, OfTheWholeFileThereIsOnlyTheLine) {
  EXPECT_STREQ(errorIn("a: 1\n", [](const YamlMap& y) { y.number("gravity"); }).what(),
               "some.yaml: line 1: missing key `gravity`");
}

TEST(Yaml, NumbersAreNumbers) {
  for (const char* bad :
       {"1.5x", "x",   ".nan", "nan",   ".inf", "inf",    "-inf", "1e999", "0x10", "1,5", "1 2",
        "+-1",  "--1", "''",   "\"1\"", "[1]",  "{a: 1}", "~",    "",      "true", "1e",  "."}) {
    const Error error = errorIn("\na: " + std::string(bad) + "\n", [](const YamlMap& y) { y.number("a"); });
    EXPECT_EQ(error.where, "a (line 2)") << bad;
  }
  EXPECT_EQ(errorIn("a: 1.5x\n", [](const YamlMap& y) { y.number("a"); }).why,
            "must be a number, not `1.5x`");
}

TEST(Yaml, ValuesOfTheWrongKindOrRange) {
  const auto refused = [](const std::string& value, const std::function<void(const YamlMap&)>& read) {
    const Error error = errorIn("a: " + value + "\n", read);
    EXPECT_EQ(error.where, "a (line 1)") << value;
  };
  refused("0", [](const YamlMap& y) { y.positive("a"); });
  refused("-1", [](const YamlMap& y) { y.notNegative("a"); });
  refused("1.5", [](const YamlMap& y) { y.integer("a"); });
  refused("1e12", [](const YamlMap& y) { y.integer("a"); });
  refused("yes", [](const YamlMap& y) { y.flag("a"); });
  refused("[a]", [](const YamlMap& y) { y.text("a"); });
  refused("''", [](const YamlMap& y) { y.text("a"); });
  refused("3", [](const YamlMap& y) { y.numbers("a"); });
  refused("[1, b]", [](const YamlMap& y) { y.numbers("a"); });
  refused("[1, .nan, 2]", [](const YamlMap& y) { y.numbers("a"); });
  refused("[1, 2]", [](const YamlMap& y) { y.vector3("a"); });
  refused("b", [](const YamlMap& y) { y.texts("a"); });
  refused("3", [](const YamlMap& y) { y.map("a"); });
  refused("3", [](const YamlMap& y) { y.maps("a"); });
  refused("[{b: 1}, 3]", [](const YamlMap& y) { y.maps("a"); });
}

TEST(Yaml, MissingFileAndFolder) {
  EXPECT_EQ(yamlErrorOf([] { YamlFile("/nowhere/at/all.yaml"); }).file, "/nowhere/at/all.yaml");
  const auto folder = test::scratchFolder();
  yamlErrorOf([&] { const YamlFile yaml(folder); });
}

}  // namespace
}  // namespace fathom
