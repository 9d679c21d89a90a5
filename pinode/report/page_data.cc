#include "pinode/report/page_data.h"

#include <utility>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

namespace mustache = kainjow::mustache;
using Align = TextTable::Align;

constexpr char kTablePartial[] = R"html(<table>
<thead><tr>{{#columns}}<th{{#number}} class="n"{{/number}}>{{header}}</th>{{/columns}}</tr></thead>
<tbody>
{{#rows}}<tr{{#strong}} class="strong"{{/strong}}>{{#cells}}<td{{#number}} class="n"{{/number}}>{{text}}</td>{{/cells}}</tr>
{{/rows}}</tbody>
</table>
)html";

constexpr char kFigurePartial[] = R"html(<figure{{#half}} class="half"{{/half}}>
{{#drawn}}{{{svg}}}{{/drawn}}{{^drawn}}<p class="missing">This figure could not be drawn: {{error}}.</p>{{/drawn}}
<figcaption>{{caption}}</figcaption>
</figure>
)html";

constexpr char kStylePartial[] = R"html(<style>
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; color: #222; background: #fff;
  max-width: 920px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { font-size: 1.6em; line-height: 1.2; margin: 0 0 4px; }
h2 { font-size: 1.2em; margin: 38px 0 10px; padding-bottom: 4px; border-bottom: 1px solid #ccc; }
h3 { font-size: 1em; margin: 24px 0 8px; }
h1, h2, h3, p, li, dt, figcaption { overflow-wrap: anywhere; }
p { margin: 8px 0; max-width: 46em; }
ul { margin: 8px 0; padding-left: 1.3em; max-width: 46em; }
.source { color: #666; margin: 0 0 18px; overflow-wrap: anywhere; }
.verdict { border-left: 6px solid #0072b2; background: #eef5fa; padding: 10px 16px; max-width: none; font-size: 1.07em; }
.verdict.bad { border-color: #d55e00; background: #fdf1e8; }
.wide { overflow-x: auto; margin: 12px 0; }
table { border-collapse: collapse; font-size: 0.93em; }
th { text-align: left; font-weight: 600; color: #555; border-bottom: 1px solid #888; vertical-align: bottom; }
th, td { padding: 3px 16px 3px 0; }
td { border-bottom: 1px solid #e6e6e6; vertical-align: baseline; }
th.n { text-align: right; }
td.n { text-align: right; white-space: pre; font-family: ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace; font-size: 0.93em; }
tr.strong td { font-weight: 600; }
dl { display: grid; grid-template-columns: fit-content(50%) 1fr; gap: 3px 22px; margin: 10px 0; }
dt { color: #555; }
dd { margin: 0; overflow-wrap: anywhere; }
figure { margin: 16px 0 24px; }
figure.half { display: inline-block; width: 48%; margin-right: 1.5%; vertical-align: top; }
figure svg { display: block; max-width: 100%; height: auto; }
figcaption { color: #555; font-size: 0.9em; margin-top: 4px; max-width: 54em; }
.missing { border: 1px dashed #999; padding: 10px 14px; color: #555; }
pre { background: #f4f4f4; padding: 10px 14px; white-space: pre-wrap; overflow-wrap: anywhere; font-size: 0.88em; }
footer { color: #777; font-size: 0.88em; margin-top: 40px; }
/* On a phone wide figures scroll like tables, so that their labels stay legible. */
@media screen and (max-width: 600px) {
  body { padding: 18px 12px 40px; }
  p, li, figcaption { overflow-wrap: anywhere; }
  table { font-size: 0.78em; }
  th, td { padding-right: 4px; }
  th:last-child, td:last-child { padding-right: 0; }
  td.n { font-size: 0.88em; }
  dl { grid-template-columns: 1fr; gap: 0; }
  dd { margin-bottom: 8px; }
  figure { overflow-x: auto; }
  figure svg { max-width: none; width: 680px; }
  figure.half { display: block; width: auto; margin-right: 0; }
  figure.half svg { max-width: 100%; width: auto; }
}
@page { margin: 16mm 15mm; }
@media print {
  body { font-size: 10pt; max-width: none; padding: 0; }
  h2, h3, h2 + p { break-after: avoid; }
  figure, tr, .verdict, pre { break-inside: avoid; }
  thead { display: table-header-group; }
  .wide { overflow: visible; }
  .verdict, pre { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
</style>)html";

PageData Partial(const char* text) {
  return PageData(mustache::partial([text] { return std::string(text); }));
}

}  // namespace

void SetIf(const std::string& name, bool present, PageData value,
           PageData* page) {
  page->set(name, present ? std::move(value) : PageData(false));
}

PageData PageList() { return PageData(PageData::type::list); }

PageData PageText(const std::string& text) {
  PageData data;
  data.set("text", text);
  return data;
}

PageData PageTexts(const std::vector<std::string>& texts) {
  PageData list = PageList();
  for (const std::string& text : texts) list.push_back(PageText(text));
  return list;
}

PageData TableData(const TextTable& table, const std::vector<bool>& strong) {
  PageData columns = PageList();
  for (const TextTable::Column& column : table.columns()) {
    PageData header;
    header.set("header", column.header);
    header.set("number", column.align == Align::kDecimal);
    columns.push_back(header);
  }
  PageData rows = PageList();
  const auto aligned = table.AlignedRows();
  for (size_t r = 0; r < aligned.size(); ++r) {
    PageData cells = PageList();
    for (size_t c = 0; c < aligned[r].size(); ++c) {
      PageData cell = PageText(aligned[r][c]);
      cell.set("number", table.columns()[c].align == Align::kDecimal);
      cells.push_back(cell);
    }
    PageData row;
    row.set("cells", cells);
    row.set("strong", r < strong.size() && strong[r]);
    rows.push_back(row);
  }
  PageData data;
  data.set("columns", columns);
  data.set("rows", rows);
  return data;
}

PageData PictureData(const ReportFigures::Picture& picture) {
  PageData data;
  data.set("caption", picture.figure.caption);
  data.set("half", picture.figure.half_width);
  data.set("drawn", !picture.svg.empty());
  data.set("svg", picture.svg);
  data.set("error", picture.error);
  return data;
}

std::string EscapeHtml(const std::string& text) {
  return mustache::html_escape(text);
}

std::string RenderPage(const char* page_template, PageData page) {
  page.set("table", Partial(kTablePartial));
  page.set("figure", Partial(kFigurePartial));
  page.set("style", Partial(kStylePartial));
  mustache::mustache view(page_template);
  CHECK(view.is_valid()) << view.error_message();
  return view.render(page);
}

}  // namespace pinode
