#include "tests/cases/case_text.h"

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "gtest/gtest.h"
#include "pinode/base/statistics.h"
#include "tests/support/gaussian_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace testing {

std::string CaseText(const std::string& path, const std::string& data) {
  const std::filesystem::path whole =
      std::filesystem::path(PINODE_SOURCE_DIR) / path;
  std::ifstream file(whole);
  EXPECT_TRUE(file) << whole;
  std::ostringstream text;
  text << file.rdbuf();
  // "record.csv", "data/silverbox/record.csv.gz".
  static const auto& entry =
      *new std::regex(R"re("(data/)?([^"/]*(/[^"]*)?\.(csv|mtx)(\.gz)?)")re");
  const std::string whole_text = text.str();
  const std::string here = whole.parent_path().string() + "/";
  std::string result;
  auto end = whole_text.begin();
  for (std::sregex_iterator at(whole_text.begin(), whole_text.end(), entry), no;
       at != no; ++at) {
    const std::smatch& match = *at;
    const bool shared = match[1].matched && !data.empty();
    result.append(end, match[0].first);
    result += "\"" + (shared ? data + "/" : here + match[1].str()) +
              match[2].str() + "\"";
    end = match[0].second;
  }
  result.append(end, whole_text.end());
  return result;
}

std::string WithTables(const std::string& text, const std::string& name,
                       const std::string& replacement) {
  std::istringstream lines(text);
  std::ostringstream result;
  std::string line;
  bool inside = false;
  bool replaced = false;
  while (std::getline(lines, line)) {
    if (line.rfind("[", 0) == 0) {
      inside = line.rfind("[[" + name + "]]", 0) == 0 ||
               line.rfind("[[" + name + ".", 0) == 0 ||
               line.rfind("[" + name + ".", 0) == 0;
    }
    if (inside && !replaced) result << replacement;
    replaced = replaced || inside;
    if (!inside) result << line << "\n";
  }
  EXPECT_TRUE(replaced) << "no table " << name;
  return result.str();
}

Case CaseOfText(const std::string& text) {
  const TemporaryFolder folder;
  Case c;
  std::string error;
  EXPECT_TRUE(ReadCase(folder.Write("case.toml", text), &c, &error)) << error;
  return c;
}

void AddNoise(double share, uint64_t seed, Case* c) {
  Gaussian random(seed);
  for (IdentificationRecord& record : c->problem.records) {
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    for (MeasuredChannel& channel : record.channels) {
      if (!channel.fit) continue;
      channel.values += share * StandardDeviationOfPresent(channel.values) *
                        random.Draw(static_cast<int>(channel.values.size()));
    }
  }
}

}  // namespace testing
}  // namespace pinode
