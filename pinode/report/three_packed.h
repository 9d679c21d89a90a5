// three.js, which draws structures in pages.

#ifndef PINODE_REPORT_THREE_PACKED_H_
#define PINODE_REPORT_THREE_PACKED_H_

namespace pinode {

// Returns the library's script, or the parts of it that structures need, packed
// by gzip, as base64. It is made when pinode is built; empty if it was not
// available.
const char* ThreePacked();

}  // namespace pinode

#endif  // PINODE_REPORT_THREE_PACKED_H_
