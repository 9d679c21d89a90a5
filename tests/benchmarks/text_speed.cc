// Speed and memory of reading large text files, on one core:
//
//   pinode_text_speed FOLDER [MEGABYTES]
//
// writes three files of so many megabytes (10^6 bytes, 1000 unless given) into
// the folder and reads each in a process of its own. text_speed.sh runs this,
// and pandas on the same files.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

constexpr int kChannels = 8;
constexpr double kRate = 200.0;

// Layout of a file.
struct SpeedFile {
  const char* name;
  const char* title;
  const char* header;  // names in front of those of the channels
  char delimiter;
  char decimal;
  bool has_clock;
};

constexpr SpeedFile kFiles[] = {
    {"plain.csv", "comma, decimal point", "t", ',', '.', false},
    {"german.csv", "semicolon, decimal comma", "Zeit [s]", ';', ',', false},
    {"clock.csv", "comma, clock times (ISO)", "timestamp", ',', '.', true},
};

// Writes the cells of a row. Numbers have six decimals.
void AppendRow(const SpeedFile& file, long row, std::string* text) {
  char cell[64];
  const double t = static_cast<double>(row) / kRate;
  if (file.has_clock) {
    // Hours of a day, from midnight on; a gigabyte has less than a day.
    const long milliseconds = 5 * row;
    const int size = std::snprintf(
        cell, sizeof cell, "2024-03-%02ldT%02ld:%02ld:%02ld.%03ld",
        1 + milliseconds / 86400000, milliseconds / 3600000 % 24,
        milliseconds / 60000 % 60, milliseconds / 1000 % 60,
        milliseconds % 1000);
    text->append(cell, static_cast<size_t>(size));
  } else {
    const int size = std::snprintf(cell, sizeof cell, "%.3f", t);
    text->append(cell, static_cast<size_t>(size));
  }
  for (int c = 0; c < kChannels; ++c) {
    const double value =
        (c + 1) * std::sin((3.0 + c) * t) + 1e-3 * static_cast<double>(row % 7);
    const int size =
        std::snprintf(cell, sizeof cell, "%c%.6f", file.delimiter, value);
    text->append(cell, static_cast<size_t>(size));
  }
  text->push_back('\n');
  if (file.decimal == '.') return;
  const size_t begin = text->rfind('\n', text->size() - 2) + 1;
  for (size_t i = begin; i < text->size(); ++i) {
    if ((*text)[i] == '.') (*text)[i] = file.decimal;
  }
}

bool WriteSpeedFile(const SpeedFile& file, const std::string& path,
                    double megabytes) {
  std::ofstream stream(path, std::ios::binary);
  std::string text = file.header;
  for (int c = 0; c < kChannels; ++c) {
    text += file.delimiter + ("a" + std::to_string(c + 1));
  }
  text += "\n";
  double bytes = 0.0;
  for (long row = 0; bytes + static_cast<double>(text.size()) < 1e6 * megabytes;
       ++row) {
    AppendRow(file, row, &text);
    if (text.size() < (1U << 22)) continue;
    stream << text;
    bytes += static_cast<double>(text.size());
    text.clear();
  }
  stream << text;
  return static_cast<bool>(stream.flush());
}

// Reads a file, and checks some of its values.
int ReadSpeedFile(const SpeedFile& file, const std::string& path) {
  TextFormat format;
  format.time_column = file.header;
  Table table;
  std::string error;
  if (!ReadTextTable(path, {}, format, &table, &error)) {
    std::cerr << error << "\n";
    return 1;
  }
  const Eigen::Index last = table.num_rows() - 1;
  for (const Eigen::Index row : {Eigen::Index{0}, last / 3, last}) {
    const double t = static_cast<double>(row) / kRate;
    for (int c = 0; c < kChannels; ++c) {
      const double expected = (c + 1) * std::sin((3.0 + c) * t) +
                              1e-3 * static_cast<double>(row % 7);
      if (std::abs(table.values(row, c + 1) - expected) > 1e-6 ||
          std::abs(table.values(row, 0) - t) > 1e-6) {
        std::cerr << path << ": wrong values in row " << row << "\n";
        return 1;
      }
    }
  }
  return 0;
}

// Runs the reader in a process of its own. Returns its CPU time, or -1.
double TimeReader(const SpeedFile& file, const std::string& path,
                  double* peak_megabytes) {
  const pid_t child = fork();
  if (child == 0) _exit(ReadSpeedFile(file, path));
  int status = 0;
  rusage usage = {};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) {
    return -1.0;
  }
  *peak_megabytes = static_cast<double>(usage.ru_maxrss) * 1024.0 / 1e6;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) +
           1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

int Main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: pinode_text_speed FOLDER [MEGABYTES]\n";
    return 2;
  }
  const std::string folder = argv[1];
  const double megabytes = argc > 2 ? std::atof(argv[2]) : 1000.0;
  if (!(megabytes > 0.0)) {
    std::cerr << "MEGABYTES is '" << argv[2]
              << "', expected a number above 0\n";
    return 2;
  }
  std::printf("%-28s %8s %8s %8s %8s\n", "file", "MB", "CPU s", "MB/s",
              "peak MB");
  for (const SpeedFile& file : kFiles) {
    const std::string path = folder + "/" + file.name;
    if (!WriteSpeedFile(file, path, megabytes)) {
      std::cerr << path << ": cannot be written. Choose a folder with room\n";
      return 1;
    }
    double peak = 0.0;
    const double seconds = TimeReader(file, path, &peak);
    if (seconds < 0.0) return 1;
    std::printf("%-28s %8.0f %8.2f %8.0f %8.0f\n", file.title, megabytes,
                seconds, megabytes / seconds, peak);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace pinode

int main(int argc, char** argv) { return pinode::Main(argc, argv); }
