// The page: one document with its script and style, all inside of the program.

#ifndef PINODE_APP_PAGE_H_
#define PINODE_APP_PAGE_H_

#include <string>

namespace pinode {

std::string PageHtml();
std::string PageScript();
std::string PageStyle();

}  // namespace pinode

#endif  // PINODE_APP_PAGE_H_
