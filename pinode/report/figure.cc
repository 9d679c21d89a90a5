#include "pinode/report/figure.h"

#include <string_view>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Removes every span from `begin` through the next `end`.
void RemoveSpans(const std::string& begin, const std::string& end,
                 std::string* text) {
  std::string kept;
  size_t at = 0;
  for (;;) {
    const size_t from = text->find(begin, at);
    const size_t to = from == std::string::npos ? from : text->find(end, from);
    if (to == std::string::npos) break;
    kept.append(*text, at, from - at);
    at = to + end.size();
  }
  kept.append(*text, at, std::string::npos);
  *text = std::move(kept);
}

// Adapts gnuplot's output for use inside HTML.
std::string TidySvg(const std::string& id, std::string text) {
  // The element needs no namespaces there. Titles would appear as the names of
  // gnuplot's plots. Its filters are for boxed labels.
  RemoveSpans(" xmlns=\"", "\"\n", &text);
  RemoveSpans(" xmlns:xlink=\"", "\"\n", &text);
  RemoveSpans("<title>", "</title>", &text);
  RemoveSpans("<desc>", "</desc>", &text);
  RemoveSpans("<filter", "</filter>", &text);
  RemoveSpans("<!--", "-->", &text);
  // Blanks in tags, unusual in HTML.
  ReplaceAll("<polygon fill = '", "<polygon fill='", &text);
  ReplaceAll("' points = '", "' points='", &text);
  // Every figure of a document defines the same marks.
  ReplaceAll("xlink:href='#gp", "href='#" + id + "_gp", &text);
  ReplaceAll(" id='gp", " id='" + id + "_gp", &text);
  ReplaceAll(" id=\"gnuplot_canvas\"", "", &text);
  return text;
}

}  // namespace

bool DrawSvgs(const std::vector<const Figure*>& figures,
              const GnuplotOptions& options, std::vector<std::string>* svgs,
              std::string* error) {
  std::string script;
  for (const Figure* figure : figures) {
    CHECK(!figure->empty()) << "figure '" << figure->id << "' shows nothing";
    // Ends the figure and clears its state for the next one.
    script += figure->script + "set output\nreset\n";
  }
  std::string text;
  if (!RunGnuplot(script, options, &text, error)) return false;
  static constexpr std::string_view kEnd = "</svg>";
  std::vector<std::string> drawn;
  size_t at = 0;
  for (const Figure* figure : figures) {
    const size_t begin = text.find("<svg", at);
    const size_t end = text.find(kEnd, begin == std::string::npos ? at : begin);
    if (begin == std::string::npos || end == std::string::npos) {
      *error = "gnuplot did not write an SVG";
      return false;
    }
    at = end + kEnd.size();
    drawn.push_back(TidySvg(figure->id, text.substr(begin, at - begin)));
  }
  *svgs = std::move(drawn);
  return true;
}

}  // namespace pinode
