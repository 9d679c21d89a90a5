// A structure in the page: a view that turns, and a still picture.

#ifndef PINODE_REPORT_STRUCTURE_VIEW_H_
#define PINODE_REPORT_STRUCTURE_VIEW_H_

#include <string>

#include "pinode/study/picture/structure_picture.h"

namespace pinode {

// The section of a page: scene, controls, the still picture that is printed and
// that stays where a browser has no WebGL, a legend, the data and the script
// that draws them with three.js. Nothing outside of the page is referred to;
// names are escaped. `picture` has nodes.
std::string StructureSection(const StructurePicture& picture);

// The still picture alone, an <svg>.
std::string StructureSvg(const StructurePicture& picture);

// A group's change in words.
std::string ChangeText(const StructurePicture& picture,
                       const StructurePicture::Group& group);

}  // namespace pinode

#endif  // PINODE_REPORT_STRUCTURE_VIEW_H_
