#include "pinode/app/page.h"

namespace pinode {
namespace {

#include "pinode/app/page_deck.inc"
#include "pinode/app/page_html.inc"
#include "pinode/app/page_pictures.inc"
#include "pinode/app/page_results.inc"
#include "pinode/app/page_script.inc"
#include "pinode/app/page_style.inc"

}  // namespace

std::string PageHtml() { return kPageHtml; }

std::string PageScript() {
  return std::string("\"use strict\";\n") + kPagePictures + kPageResults +
         kPageDeck + kPageScript;
}

std::string PageStyle() { return kPageStyle; }

}  // namespace pinode
