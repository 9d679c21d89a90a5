// three.js, which draws structures in pages.

#ifndef PINODE_REPORT_THREE_PACKED_H_
#define PINODE_REPORT_THREE_PACKED_H_

namespace pinode {

// The library's script, or the parts of it that structures need, packed by
// gzip, as base64; empty where there was none. Made when pinode is built.
const char* ThreePacked();

}  // namespace pinode

#endif  // PINODE_REPORT_THREE_PACKED_H_
