// A structure in the page: a rotatable view, and a still picture.

#ifndef PINODE_REPORT_STRUCTURE_VIEW_H_
#define PINODE_REPORT_STRUCTURE_VIEW_H_

#include <string>

#include "pinode/study/picture/structure_picture.h"

namespace pinode {

// Returns the section of a page: scene, controls, the still picture for
// printing and for browsers without WebGL, a legend, the data and the script
// that draws them with three.js. There are no external references, and names
// are escaped. `picture` has nodes.
std::string StructureSection(const StructurePicture& picture);

// Returns the still picture alone, an <svg>.
std::string StructureSvg(const StructurePicture& picture);

// Returns a group's change in words.
std::string ChangeText(const StructurePicture& picture,
                       const StructurePicture::Group& group);

}  // namespace pinode

#endif  // PINODE_REPORT_STRUCTURE_VIEW_H_
