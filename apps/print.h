// The programs' only way to standard output and standard error.

#ifndef PINODE_APPS_PRINT_H_
#define PINODE_APPS_PRINT_H_

namespace pinode {

// Writes to standard output as std::printf does. Names come from files of
// strangers: what a terminal would act upon is escaped (printable.h).
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void Print(const char* format, ...);

// Writes one line to standard error, likewise. `format` has no line end.
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
void PrintError(const char* format, ...);

}  // namespace pinode

#endif  // PINODE_APPS_PRINT_H_
