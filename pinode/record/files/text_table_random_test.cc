// Random files of loggers: nearly all are read, none wrongly.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"
#include "tests/support/logger_files_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

// Number of files; the variable is for longer studies.
int NumLoggerFiles() {
  const char* number = std::getenv("PINODE_LOGGER_FILES");
  return number != nullptr ? std::atoi(number) : 200;
}

// Seed of the files; the variable makes others.
unsigned LoggerFileSeed() {
  const char* seed = std::getenv("PINODE_LOGGER_SEED");
  return seed != nullptr ? static_cast<unsigned>(std::atoi(seed)) : 1;
}

// Returns what differs between a file and the table that was read; empty: it
// was read rightly.
std::string Difference(const LoggerFile& file, const Table& table) {
  if (table.num_rows() != static_cast<Eigen::Index>(file.values[0].size())) {
    return "rows: " + std::to_string(table.num_rows());
  }
  for (size_t c = 0; c < file.names.size(); ++c) {
    const int place = table.FindColumn(file.names[c]);
    if (place < 0) return "no column " + file.names[c];
    if (table.units[static_cast<size_t>(place)] != file.units[c]) {
      return "unit of " + file.names[c] + ": " +
             table.units[static_cast<size_t>(place)];
    }
    for (Eigen::Index i = 0; i < table.num_rows(); ++i) {
      const double read = table.values(i, place);
      const double written = file.values[c][static_cast<size_t>(i)];
      if (read == written || (std::isnan(read) && std::isnan(written))) {
        continue;
      }
      return file.names[c] + ", row " + std::to_string(i) + ": " +
             std::to_string(read) + " for " + std::to_string(written);
    }
  }
  if (file.time.empty()) return "";
  const int place = table.FindColumn(file.time);
  if (place < 0) return "no time";
  const double second = table.time_unit == "s"    ? 1.0
                        : table.time_unit == "ms" ? 1e-3
                                                  : 0.0;
  for (Eigen::Index i = 0; i < table.num_rows(); ++i) {
    const double read =
        second * (table.values(i, place) - table.values(0, place));
    const double written = file.seconds[static_cast<size_t>(i)];
    if (std::abs(read - written) > file.time_error) {
      return "time, row " + std::to_string(i) + ": " + std::to_string(read) +
             " s for " + std::to_string(written) + " s";
    }
  }
  return "";
}

// True if a refusal names the key that helps.
bool NamesAKey(const std::string& error) {
  for (const char* key :
       {"`delimiter`", "`decimal`", "`header_lines", "`time_format`",
        "`time_unit`", "`encoding`", "`sampling_rate_hz`", "`time`"}) {
    if (error.find(key) != std::string::npos) return true;
  }
  return false;
}

TEST(TextTableRandomTest, ReadsNearlyAllAndNoneWrongly) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("logger.csv");
  const int num_files = NumLoggerFiles();
  LoggerFileWriter writer(LoggerFileSeed());
  int num_read = 0;
  int num_times = 0;
  int num_found_times = 0;
  for (int i = 0; i < num_files; ++i) {
    const LoggerFile file = writer.Write();
    folder.Write("logger.csv", file.text);
    // As pinode_modes --columns=all has it: the time and the channels are
    // found.
    TextOutline outline;
    std::string error;
    Table table;
    TextFormat format;
    format.time_column = file.time;
    const bool is_read = ReadTextTable(path, {}, format, &table, &error);
    if (is_read && ReadTextOutline(path, {}, &outline, &error)) {
      std::vector<std::string> channels;
      for (size_t c = 0; c < outline.columns.size(); ++c) {
        if (outline.is_channel[c]) channels.push_back(outline.columns[c].name);
      }
      EXPECT_EQ(channels, file.names) << file.mix << "\n"
                                      << file.text.substr(0, 700);
      if (!file.time.empty()) ++num_times;
      if (outline.time_column >= 0) {
        ++num_found_times;
        EXPECT_EQ(
            outline.columns[static_cast<size_t>(outline.time_column)].name,
            file.time)
            << file.mix;
      }
    }
    // As a case has it, by name.
    if (is_read) {
      const std::string difference = Difference(file, table);
      EXPECT_EQ(difference, "") << file.mix << "\n"
                                << table.reading << "\n"
                                << file.text.substr(0, 700);
      if (difference.empty()) ++num_read;
    } else {
      EXPECT_TRUE(NamesAKey(error)) << error << "\n" << file.mix;
      if (std::getenv("PINODE_LOGGER_FILES") != nullptr) {
        std::printf("refused: %s\n  %s\n", file.mix.c_str(), error.c_str());
      }
    }
  }
  std::printf("%d of %d files are read, the time found in %d of %d\n", num_read,
              num_files, num_found_times, num_times);
  EXPECT_GE(num_read, num_files * 95 / 100);
  EXPECT_GE(num_found_times, num_times * 95 / 100);
}

}  // namespace
}  // namespace pinode
