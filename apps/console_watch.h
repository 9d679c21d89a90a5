// Fits that are watched on a console.

#ifndef PINODE_APPS_CONSOLE_WATCH_H_
#define PINODE_APPS_CONSOLE_WATCH_H_

#include "pinode/case/run/fit_case.h"

namespace pinode {

// Progress on standard error where `show_progress`, troubles in any case, and
// an end at an interrupt.
FitWatch ConsoleWatch(bool show_progress);

}  // namespace pinode

#endif  // PINODE_APPS_CONSOLE_WATCH_H_
