#include "pinode/record/files/text_format.h"

namespace pinode {

std::string TextFormat::AsText() const {
  std::string text;
  for (const std::string& part : {encoding, std::to_string(header_lines),
                                  std::to_string(static_cast<int>(delimiter)),
                                  std::to_string(static_cast<int>(decimal)),
                                  time_format, time_column, time_unit}) {
    text += std::to_string(part.size()) + ":" + part;
  }
  return text;
}

}  // namespace pinode
