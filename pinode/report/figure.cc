#include "pinode/report/figure.h"

#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Removes everything from `begin` through the next `end`, everywhere.
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

}  // namespace

bool DrawFigure(const Figure& figure, const GnuplotOptions& options,
                std::string* svg, std::string* error) {
  CHECK(!figure.empty()) << "figure '" << figure.id << "' shows nothing";
  std::string text;
  if (!RunGnuplot(figure.script, options, &text, error)) return false;
  const size_t begin = text.find("<svg");
  const size_t end = text.rfind("</svg>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) {
    *error = "gnuplot did not write an SVG";
    return false;
  }
  text = text.substr(begin, end + 6 - begin);
  // Inside HTML the element needs no namespaces; titles would pop up as the
  // names of gnuplot's plots; its filters are for boxed labels.
  RemoveSpans(" xmlns=\"", "\"\n", &text);
  RemoveSpans(" xmlns:xlink=\"", "\"\n", &text);
  RemoveSpans("<title>", "</title>", &text);
  RemoveSpans("<desc>", "</desc>", &text);
  RemoveSpans("<filter", "</filter>", &text);
  RemoveSpans("<!--", "-->", &text);
  // Blanks in tags, where no reader of HTML expects them.
  ReplaceAll("<polygon fill = '", "<polygon fill='", &text);
  ReplaceAll("' points = '", "' points='", &text);
  // Every figure of a document defines the same marks.
  ReplaceAll("xlink:href='#gp", "href='#" + figure.id + "_gp", &text);
  ReplaceAll(" id='gp", " id='" + figure.id + "_gp", &text);
  ReplaceAll(" id=\"gnuplot_canvas\"", "", &text);
  *svg = std::move(text);
  return true;
}

}  // namespace pinode
