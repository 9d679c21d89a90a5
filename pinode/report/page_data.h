// Parts of pages as data for their templates (mustache). Only for the sources
// of this folder: the header of that library is wide.

#ifndef PINODE_REPORT_PAGE_DATA_H_
#define PINODE_REPORT_PAGE_DATA_H_

#include <kainjow/mustache.hpp>
#include <string>
#include <vector>

#include "pinode/report/report_figures.h"
#include "pinode/report/text_table.h"

namespace pinode {

using PageData = kainjow::mustache::data;

// Sets a section of the page if it is present.
void SetIf(const std::string& name, bool present, PageData value,
           PageData* page);

PageData PageList();
PageData PageText(const std::string& text);
PageData PageTexts(const std::vector<std::string>& texts);

// Returns a table; `strong`: rows to be printed bold.
PageData TableData(const TextTable& table,
                   const std::vector<bool>& strong = {});

PageData PictureData(const ReportFigures::Picture& picture);

// Escapes text for HTML that is made outside of templates.
std::string EscapeHtml(const std::string& text);

// Returns the page made from `page_template` and `page`; {{>table}},
// {{>figure}} and {{>style}} are shared by all pages.
std::string RenderPage(const char* page_template, PageData page);

}  // namespace pinode

#endif  // PINODE_REPORT_PAGE_DATA_H_
