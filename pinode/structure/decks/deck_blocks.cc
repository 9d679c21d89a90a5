#include "pinode/structure/decks/deck_blocks.h"

#include <string_view>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

bool AddBlocks(const std::string& path, const std::string& content, int depth,
               DeckIncludes* includes, std::vector<DeckBlock>* blocks,
               std::string* error) {
  // The last line gets the same line end as the others.
  const bool cut = !content.empty() && content.back() != '\n' &&
                   content.find("\r\n") != std::string::npos;
  const std::string completed = cut ? content + "\r\n" : std::string();
  LineReader lines(path, cut ? completed : content);
  std::string_view line;
  while (lines.NextRaw(&line)) {
    const std::string_view text = StripBlanks(line);
    if (text.empty() || text[0] != '*' || text.substr(0, 2) == "**") {
      if (blocks->empty()) blocks->emplace_back();
      blocks->back().lines.emplace_back(line);
      continue;
    }
    DeckBlock block;
    block.place = path + ":" + std::to_string(lines.number());
    block.head.emplace_back(line);
    std::string whole(text);
    while (whole.back() == ',' && lines.NextRaw(&line)) {
      block.head.emplace_back(line);
      const std::string_view more = StripBlanks(line);
      if (!more.empty() && more.substr(0, 2) != "**") whole += more;
    }
    block.keyword = ParseDeckKeyword(whole);
    if (!block.keyword.Is("*INCLUDE")) {
      if (block.keyword.Find("INPUT") != nullptr) {
        *error = block.place + ": " + block.keyword.name +
                 " has INPUT, expected its data below it";
        return false;
      }
      blocks->push_back(std::move(block));
      continue;
    }
    std::string other, included;
    if (!includes->Read(lines, block.keyword, path, depth, &other, &included,
                        error) ||
        !AddBlocks(other, included, depth + 1, includes, blocks, error)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::vector<size_t> DeckBlock::DataLines() const {
  std::vector<size_t> data;
  for (size_t i = 0; i < lines.size(); ++i) {
    const std::string_view text = StripBlanks(lines[i]);
    if (!text.empty() && text.substr(0, 2) != "**") data.push_back(i);
  }
  return data;
}

bool ReadDeckBlocks(const std::string& path, const std::string& content,
                    std::vector<DeckBlock>* blocks, std::string* error) {
  blocks->clear();
  DeckIncludes includes(path);
  return AddBlocks(path, content, 0, &includes, blocks, error);
}

std::string DeckLineEnd(const std::string& line) {
  return !line.empty() && line.back() == '\r' ? "\r" : "";
}

std::string FormatDeckBlocks(const std::vector<DeckBlock>& blocks) {
  std::string text;
  for (const DeckBlock& block : blocks) {
    for (const std::string& line : block.head) text += line + "\n";
    for (const std::string& line : block.lines) text += line + "\n";
  }
  return text;
}

}  // namespace pinode
