#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/base64.h"
#include "bench/paper_tables.h"
#include "bench/report.h"
#include "bench/table.h"
#include "bench/test_suite.h"
#include "io/test_folder.h"

namespace msf {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

Table SmallTable() {
  Table table{"t", "A < B", "note", {{"", 1}, {"group", 2}}, {"name", "x", "y"}, {}};
  table.rows.push_back({"a|b", "1,5", Cell("2", true)});
  table.rows.push_back({Cell("p", true), "", Cell("3", true)});
  return table;
}

const std::vector<Cell>& RowOf(const Table& table, const std::string& label,
                               const std::string& source = "") {
  for (const std::vector<Cell>& row : table.rows) {
    if (row[0].text == label && (source.empty() || row[1].text == source)) return row;
  }
  static const std::vector<Cell> none(20, Cell("no such row"));
  return none;
}

TEST(Table, HasThreeForms) {
  EXPECT_EQ(TableToCsv(SmallTable()), "name,\"group, x\",\"group, y\"\na|b,\"1,5\",2\np,,3\n");
  EXPECT_THAT(TableToMarkdown(SmallTable()),
              AllOf(HasSubstr("| name | group, x | group, y |"), HasSubstr("| a\\|b | 1,5 | *2* |"),
                    HasSubstr("| *p* | - | *3* |"), HasSubstr("note")));
  EXPECT_THAT(TableToHtml(SmallTable()), AllOf(HasSubstr("A &lt; B"), HasSubstr("colspan=\"2\""),
                                               HasSubstr("<td class=\"published\">2</td>"),
                                               HasSubstr("<tr class=\"published\">")));
}

TEST(Base64, EncodesAnyLength) {
  EXPECT_EQ(EncodeBase64(""), "");
  EXPECT_EQ(EncodeBase64("f"), "Zg==");
  EXPECT_EQ(EncodeBase64("fo"), "Zm8=");
  EXPECT_EQ(EncodeBase64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(EncodeBase64("\xff\xfe\xfd"), "//79");
}

TEST(PublishedFigures, AreThoseOfThePaper) {
  const StatusOr<PublishedFigures> published = LoadPublishedFigures();
  ASSERT_TRUE(published.ok()) << published.message();
  EXPECT_EQ(published->threshold.size(), 5u);
  EXPECT_EQ(published->detectors.size(), 5u);
  EXPECT_EQ(published->ate.size(), 10u);
  EXPECT_EQ(published->rpe.size(), 10u);
  EXPECT_EQ(published->compared.size(), 24u);
  EXPECT_EQ(published->runtime.front().fps, 233.1);
}

TEST(PaperTables, PutOursBesideThePublished) {
  const PublishedFigures published = *LoadPublishedFigures();
  const Table five = AbsoluteErrorTable(TestResults(), published);
  const std::vector<Cell>& theirs = RowOf(five, "walking_xyz", "published");
  EXPECT_EQ(theirs[2].text, "0.2399");
  EXPECT_TRUE(theirs[2].published);
  EXPECT_EQ(theirs[8].text, "0.0134");
  const std::vector<Cell>& ours = RowOf(five, "walking", "measured");
  EXPECT_EQ(ours[2].text, "0.2050") << "median of the repeats";
  EXPECT_EQ(ours[6].text, "0.2000-0.2100");
  EXPECT_EQ(ours[7].text, "50.0 %") << "the lowest coverage";
  EXPECT_EQ(ours[8].text, "0.0105");
  EXPECT_FALSE(ours[2].published);
  EXPECT_EQ(RowOf(five, "sitting_static", "published")[2].text, "0.0108")
      << "also of sequences that are not here";
  const Table six = RelativeErrorTable(TestResults(), published);
  EXPECT_EQ(RowOf(six, "walking_xyz", "published")[8].text, "0.0122");
}

TEST(PaperTables, CompareWithOtherSystems) {
  const std::vector<Table> tables = ComparisonTables(TestResults(), *LoadPublishedFigures());
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(RowOf(tables[0], "walking")[1].text, "0.0571/0.0129");
  EXPECT_EQ(RowOf(tables[0], "walking").back().text, "0.0105/0.0052 (50.0 %)");
  EXPECT_EQ(RowOf(tables[1], "DynaSLAM")[1].text, "0.0150");
  EXPECT_EQ(RowOf(tables[1], "full (measured)")[1].text, "0.0105 (50.0 %)");
}

TEST(PaperTables, TellWhatDidNotSucceed) {
  BenchResults results = TestResults();
  results.results[0].status = "timed_out";
  results.results[0].ate_m.reset();
  const Table overview = OverviewTable(results);
  EXPECT_EQ(overview.rows[0][3].text, "1 of 2 ok: 1 timed out");
  EXPECT_EQ(overview.rows[0][4].text, "0.2100");
  EXPECT_EQ(RowOf(overview, "walking", "full")[6].text, "0.05") << "over off without people";
  EXPECT_EQ(GatherFacts(results).problems.size(), 1u);
}

TEST(PaperTables, TimesAreOfTheRunsThatSucceeded) {
  const Table eight = RuntimeTable(TestResults(), *LoadPublishedFigures());
  const std::vector<Cell>& row = RowOf(eight, "walking");
  EXPECT_EQ(row[4].text, "10.5");
  EXPECT_EQ(row[7].text, "3.0") << "12 frames in 4 s";
  EXPECT_EQ(row[8].text, "150") << "6 s of CPU in 4 s";
  EXPECT_EQ(eight.rows[2][13].text, "");
  EXPECT_THAT(eight.rows[0], Contains(testing::Field(&Cell::text, "233.1")));
}

TEST(PaperTables, ThresholdsAndDetectors) {
  const PublishedFigures published = *LoadPublishedFigures();
  BenchResults results = TestResults();
  EXPECT_TRUE(ThresholdTables(results, published).empty());
  EXPECT_TRUE(DetectorTables(results, published).empty());
  results.suite.variants[1].threshold_px = 1.5;
  for (TaskResult& result : results.results) {
    result.static_kept = 0.9;
    result.dynamic_removed = 0.8;
  }
  const std::vector<Table> one = ThresholdTables(results, published);
  ASSERT_EQ(one.size(), 2u);
  const std::vector<Cell>& row = RowOf(one[0], "1.5");
  EXPECT_EQ(row[1].text, "0.0134");
  EXPECT_EQ(row[4].text, "");
  EXPECT_EQ(row[8].text, "0.0105");
  EXPECT_EQ(row[9].text, "90.0");
  TaskResult detector;
  detector.id = "detectors/mine";
  detector.variant = "mine";
  detector.detector = DetectorFigures{0.7, 0.6, 0.65, 0.4, 3.19, 8.9};
  detector.timing.detector_ms = 20;
  results.results.push_back(detector);
  const std::vector<Table> tables = DetectorTables(results, published);
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(RowOf(tables[0], "mine")[4].text, "65.0");
  EXPECT_EQ(RowOf(tables[0], "mine")[8].text, "50.0");
  EXPECT_EQ(tables[1].rows.size(), 6u);
}

TEST(Report, IsOneFileThatFetchesNothing) {
  const BenchResults results = TestResults();
  const std::vector<Table> tables = PaperTables(results, *LoadPublishedFigures());
  const std::vector<Figure> figures = {{"f", "", "a figure", "its note", "<svg/>"},
                                       {"g", "walking", "of a sequence", "", "<svg/>"}};
  const std::string html = HtmlReport(results, tables, figures);
  for (const char* outside : {"src=\"http", "href=\"http", "url(", "<script", "@import"})
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  EXPECT_THAT(html, AllOf(HasSubstr("data:image/svg+xml;base64," + EncodeBase64("<svg/>")),
                          HasSubstr("https://example.org/not_here.tgz"), HasSubstr("Table 8"),
                          HasSubstr("id=\"sequence-walking\"")));
  EXPECT_THAT(MarkdownReport(results, tables, figures),
              AllOf(HasSubstr("![a figure](figures/f.svg)"), HasSubstr("commit abc"),
                    HasSubstr("### Table 5")));
}

}  // namespace
}  // namespace msf
