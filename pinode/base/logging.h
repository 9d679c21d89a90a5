// The only access to logging: every other file includes this one instead of
// glog.
//
// CHECK is for mistakes of the calling code (null pointers, wrong sizes). It
// states the values and the remedy. Bad files, options or data never cause a
// CHECK: functions return `false` with a message.

#ifndef PINODE_BASE_LOGGING_H_
#define PINODE_BASE_LOGGING_H_

#include <glog/logging.h>

#endif  // PINODE_BASE_LOGGING_H_
