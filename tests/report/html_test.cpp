#include "kinecal/report/html.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/text/name_list.hpp"
#include "support/hostile_names.hpp"
#include "support/shell_words.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A report in which every text is hostile.
ReportData hostile(const std::string& name) {
  ReportData data;
  data.robot = data.version = data.date = data.recorded = data.summary = name;
  data.command = {"kinecal", name};
  data.reasons = {name};
  data.inputs = {{name, name, 12, name}};
  data.steps.push_back({.name = name, .converged = true, .termination = name, .costs = {2.0, 1.0}});
  ReportedBlock& block = data.blocks.emplace_back();
  block.name = block.type = name;
  block.unit = "m";
  block.components = 3;
  block.sigma = 1e-3;
  for (int i = 0; i < 4; ++i) {
    data.samples.push_back({i + 1, name, i == 2, false, name, 1.0 + i});
    block.features.push_back({i, {i}, 0.01 * i, 0.001 * i, {0.001 * i, 0.0, 0.0}});
  }
  data.samples.push_back({5, name, true, true, name, 0.0});
  data.parameters.push_back({name, name, "rad", 0.1, 0.0, 0.01, ""});
  data.parameters.push_back({name + "2", name, "m", 0.1, 0.0, std::nullopt, name});
  data.correlated = {name, name + "2"};
  data.correlation = {{1.0, 0.5}, {0.5, 1.0}};
  data.unobservable = {{{name, 1.0}, {name + "2", -0.5}}};
  data.hold = {name};
  data.rank = 1;
  data.compared = {{.frame = name, .in = name, .position = 1e-3, .rotation = 1e-3}};
  data.workspace = {{{0.1, 0.2, 0.3}, 0.001}, {{0.2, 0.2, 0.3}, 0.002}};
  return data;
}

/// What is between two texts.
std::string between(const std::string& text, const std::string& first, const std::string& last) {
  const std::size_t from = text.find(first);
  if (from == std::string::npos) return "";
  return text.substr(from + first.size(), text.find(last, from) - from - first.size());
}

/// The page without what is not markup: the content of its style and scripts.
std::string markup_of(std::string page) {
  for (const std::string tag : {"style", "script"}) {
    const std::string end = "</" + tag + ">";
    for (std::size_t at = 0; (at = page.find("<" + tag, at)) != std::string::npos;) {
      const std::size_t open = page.find('>', at) + 1;
      page.erase(open, page.find(end, open) - open);
      at = open;
    }
  }
  page.erase(0, page.find('\n') + 1);  // <!doctype html>
  return page;
}

TEST(Html, ACaptionOfSeveralChartsStandsBelowTheFirst) {
  const auto chart = [](const char* title, const char* caption) {
    return Chart{"errors", title, title, caption, "<svg/>"};
  };
  EXPECT_EQ(detail::html_figures({chart("a", "of both"), chart("b", "of both"), chart("c", "own")}),
            "<div class=\"pair\">"
            "<figure><h3>a</h3><svg/><figcaption>of both</figcaption></figure>\n"
            "<figure><h3>b</h3><svg/></figure>\n"
            "<figure><h3>c</h3><svg/><figcaption>own</figcaption></figure>\n"
            "</div>\n");
  EXPECT_EQ(detail::html_figures({}), "");
}

TEST(Html, IsWellFormedWhateverNamesContain) {
  for (const std::string& name :
       {std::string("<script>alert(1)</script>"), std::string("\"'><img src=x onerror=alert(1)>"),
        std::string("]]> --> &amp; \\u2028 \xe2\x80\xa8"), std::string("\xd7\xa2\xd7\x91\xd7\xa8"),
        std::string("\xf0\x9f\xa4\x96"), std::string(5000, 'x'), std::string("\xff\xfe\x01 broken"),
        std::string("gpj.\u202Eexe \u2066\u200F"), std::string()}) {
    const std::string page = html_report(hostile(name), "");
    pugi::xml_document document;
    const auto parsed = document.load_string(markup_of(page).c_str());
    ASSERT_TRUE(parsed) << parsed.description() << " with " << name.substr(0, 40);
    EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
    EXPECT_THAT(page, Not(HasSubstr("<img")));
    EXPECT_EQ(page.find_first_of("\x01\xff\xfe"), std::string::npos);
    EXPECT_THAT(page, Not(HasSubstr("\u202E"))) << "turns the direction of writing";
    EXPECT_THAT(page, Not(HasSubstr("\u200F")));
    EXPECT_TRUE(document.select_node("//header[@class='verdict good']"));
    EXPECT_FALSE(document.select_node("//@onerror | //@onclick | //@style"));
  }
}

/// All text of an element, as a browser copies it.
std::string copied(const pugi::xml_node& element) {
  std::string text;
  for (const pugi::xpath_node& part : element.select_nodes(".//text()"))
    text += part.node().value();
  return text;
}

TEST(Html, CommandsAreCopiedAsWordsWhateverNamesContain) {
  for (const std::string& name : test::kHostileNames) {
    ReportData data = hostile(name);
    data.next = "do it:\n  " + data.command.str();
    const std::string page = html_report(data, detail::json_in_html({{"name", name}}));
    pugi::xml_document document;
    ASSERT_TRUE(
        document.load_string(markup_of(page).c_str(), pugi::parse_default | pugi::parse_ws_pcdata))
        << name;
    EXPECT_EQ(document.select_nodes("//script").size(), 2u) << "the scene and the page's own";
    const std::string scene = between(page, "id=\"scene\">", "</script>");
    EXPECT_EQ(detail::Json::parse(scene).at("name"), name);
    int commands = 0;
    for (const pugi::xpath_node& code : document.select_nodes("//pre[@class='command']/code")) {
      const test::PastedCommand pasted = test::paste(copied(code.node()));
      EXPECT_FALSE(pasted.did_more) << name;
      EXPECT_THAT(pasted.words, testing::ElementsAre("kinecal", name));
      ++commands;
    }
    EXPECT_EQ(commands, 2);
    const test::PastedCommand hold =
        test::paste(copied(document.select_node("//div[@class='open']/p/code").node()));
    EXPECT_FALSE(hold.did_more) << name;
    EXPECT_THAT(hold.words, testing::Contains(testing::EndsWith(list_entry(name))));
  }
}

TEST(Html, ElidesLongNamesWithTheWholeNameAsTooltip) {
  const std::string name(5000, 'x');
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(markup_of(html_report(hostile(name), "")).c_str()));
  int elided = 0;
  for (const pugi::xpath_node& found : document.select_nodes("//td//text() | //li//text()")) {
    const std::string text = found.node().value();
    EXPECT_LT(text.size(), 300u) << found.node().parent().name();
    if (text.find("…") == std::string::npos) continue;
    ++elided;
    EXPECT_THAT(found.node().parent().attribute("title").value(), testing::StartsWith(name));
  }
  EXPECT_GT(elided, 12) << "error block, parameters, steps, inputs, samples and their faults";
  EXPECT_EQ(document.select_node("//pre[@class='command']/code").node().text().get(),
            "kinecal " + name)
      << "it is copied";
}

TEST(Html, IsolatesNamesThatAreWrittenFromRightToLeft) {
  const std::string name = "זרוע ימין";
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(markup_of(html_report(hostile(name), "")).c_str()));
  int isolated = 0;
  for (const pugi::xpath_node& found : document.select_nodes("//body//text()")) {
    const pugi::xml_node parent = found.node().parent();
    const std::string text = found.node().value(), element = parent.name();
    if (text.find("זרוע") == std::string::npos) continue;
    const bool in_bdi = element == "bdi", has_marks = text.find("\u2068") != std::string::npos;
    EXPECT_TRUE(in_bdi || has_marks || element == "title" || element == "desc") << element << text;
    ++isolated;
  }
  EXPECT_GT(isolated, 20);
}

TEST(HtmlSentence, KeepsItsWordsAndElidesLongOnes) {
  const std::string page = [] {
    ReportData data = hostile("arm");
    data.reasons = {"noise of 'זרוע ימין' is 40 mm, that of " + std::string(200, 'y') + " 2 mm"};
    return html_report(data, "");
  }();
  EXPECT_THAT(page, HasSubstr("<li>noise of <bdi>\u2068&#39;זרוע ימין&#39;\u2069</bdi> is 40 mm, "
                              "that of <bdi title=\"yyyy"));
  EXPECT_THAT(page, HasSubstr("yyy</bdi> 2 mm</li>"));
}

TEST(Html, AllowsItsOwnStyleAndScriptOnly) {
  const std::string page = html_report(hostile("arm"), R"({"links": []})");
  const std::string policy = between(page, "Content-Security-Policy\" content=\"", "\"/>");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, Not(HasSubstr("unsafe")));
  EXPECT_THAT(policy, Not(HasSubstr("http")));
  const auto source = [](const std::string& text) {
    const auto digest = sha256(text);
    return "'sha256-" + base64(std::string(digest.begin(), digest.end())) + "'";
  };
  EXPECT_THAT(policy, HasSubstr("style-src " + source(between(page, "<style>", "</style>"))));
  EXPECT_THAT(policy, HasSubstr("script-src " + source(between(page, "<script>", "</script>"))));
  EXPECT_THAT(page, HasSubstr(R"(<script type="application/json" id="scene">{"links": []})"));
}

TEST(Html, SaysVerdictReasonsAndWhatIsWrong) {
  ReportData data = hostile("elbow");
  data.verdict = Grade::do_not_use;
  data.reasons = {"noise of 'hand_eye' is 40 mm"};
  const std::string page = html_report(data, "");
  EXPECT_THAT(page, HasSubstr("<header class=\"verdict bad\">"));
  EXPECT_THAT(page, HasSubstr("do not use"));
  EXPECT_THAT(page, HasSubstr("noise of &#39;hand_eye&#39; is 40 mm"));
  EXPECT_THAT(page, HasSubstr("5.730 deg"));                   // 0.1 rad
  EXPECT_THAT(page, HasSubstr("&plusmn; 0.573"));              // 0.01 rad
  EXPECT_THAT(page, HasSubstr("data-sample=\"3\">sample 3"));  // the bad one
  EXPECT_THAT(page, HasSubstr("--hold elbow"));
}

TEST(Html, IsTheSameBytesForTheSameData) {
  EXPECT_EQ(html_report(hostile("arm"), ""), html_report(hostile("arm"), ""));
}

TEST(Html, ShowsACalibrationThatNeverBegan) {
  ReportData data;
  data.robot = "arm";
  data.verdict = Grade::do_not_use;
  data.steps.push_back({.name = "one", .termination = "failed: no residuals"});
  ReportedBlock& block = data.blocks.emplace_back();
  block.name = "hand_eye";
  block.unit = "m";
  block.rms_before = block.rms_after = std::numeric_limits<double>::quiet_NaN();
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(markup_of(html_report(data, "")).c_str()));
}

TEST(HtmlLines, StayLinesAndAreEscaped) {
  EXPECT_EQ(detail::html_lines("a <b>\n  c\n\nd"), "a &lt;b&gt;\n  c\n\nd\n");
  EXPECT_EQ(detail::html_lines(""), "");
  EXPECT_EQ(detail::html_paragraphs("a & b\n\nc\n"), "<p>a &amp; b</p>\n<p>c</p>\n");
}

}  // namespace
}  // namespace kinecal
