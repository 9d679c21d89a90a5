#include "apps/help_text.h"

#include <gflags/gflags.h>

#include <sstream>
#include <string>
#include <vector>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr size_t kLineWidth = 80;
// Column of descriptions; help2man requires 20 at least.
constexpr size_t kDescription = 20;

bool IsOfPrograms(const gflags::CommandLineFlagInfo& flag) {
  return flag.filename.find("apps/") != std::string::npos;
}

bool IsOfLog(const gflags::CommandLineFlagInfo& flag) {
  return flag.name == "v" || flag.name == "vmodule";
}

template <typename Condition>
std::vector<gflags::CommandLineFlagInfo> FlagsWhere(Condition condition) {
  std::vector<gflags::CommandLineFlagInfo> all, chosen;
  gflags::GetAllFlags(&all);
  for (const auto& flag : all) {
    if (condition(flag)) chosen.push_back(flag);
  }
  return chosen;
}

// Returns the words of `text` in lines that begin with `indent` blanks.
std::string Wrapped(const std::string& text, size_t indent) {
  std::istringstream words(text);
  std::string line, lines;
  for (std::string word; words >> word;) {
    if (!line.empty() && indent + line.size() + 1 + word.size() > kLineWidth) {
      lines += std::string(indent, ' ') + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + std::string(indent, ' ') + line + "\n";
}

// Returns the name of a flag's value in capitals: as in the usage, else its
// type.
std::string ValueName(const gflags::CommandLineFlagInfo& flag,
                      const std::string& usage) {
  if (flag.type == "bool") return "";
  const std::string start = "--" + flag.name + "=";
  const size_t found = usage.find(start);
  if (found != std::string::npos) {
    // The name ends at the bracket that may enclose the flag.
    size_t end = found + start.size();
    for (int open = 0; end < usage.size() && usage[end] != ' ' &&
                       usage[end] != '\n' && (usage[end] != ']' || open > 0);
         ++end) {
      open += (usage[end] == '[') - (usage[end] == ']');
    }
    return usage.substr(found + start.size(), end - found - start.size());
  }
  if (flag.type == "string") return "TEXT";
  return flag.type == "double" ? "NUMBER" : "INTEGER";
}

std::string FlagText(const gflags::CommandLineFlagInfo& flag,
                     const std::string& usage) {
  const std::string value = ValueName(flag, usage);
  std::string description = flag.description;
  if (!description.empty() && description.back() == '.') description.pop_back();
  if (flag.type != "bool") {
    if (!flag.default_value.empty()) {
      // gflags prints 17 digits of a number.
      double number;
      const bool is_number =
          flag.type == "double" && ParseDouble(flag.default_value, &number);
      description += "; default: " +
                     (is_number ? FormatNumber(number) : flag.default_value);
    }
  } else if (flag.default_value == "true") {
    description += ", unless --no" + flag.name;
  }
  return "  --" + flag.name + (value.empty() ? "" : "=" + value) + "\n" +
         Wrapped(description, kDescription);
}

}  // namespace

std::vector<std::string> OwnFlagNames() {
  std::vector<std::string> names;
  for (const auto& flag : FlagsWhere(
           [](const auto& f) { return IsOfPrograms(f) || IsOfLog(f); })) {
    names.push_back(flag.name);
  }
  return names;
}

std::string HelpText(const std::string& usage) {
  const size_t end = usage.find("\n\n");
  const std::string synopsis = usage.substr(0, end);
  std::string text = "Usage: " + synopsis + "\n\n" +
                     Wrapped(usage.substr(end + 2), 0) + "\nFlags:\n";
  for (const auto& flag : FlagsWhere(IsOfPrograms)) {
    text += FlagText(flag, synopsis);
  }
  text += "  --help\n" + Wrapped("prints this and exits", kDescription);
  text +=
      "  --version\n" + Wrapped("prints the version and exits", kDescription);
  text += "\nLogging, to standard error:\n";
  for (const auto& flag : FlagsWhere(IsOfLog)) {
    text += FlagText(flag, synopsis);
  }
  return text +
         "\nExit status:\n"
         "0 done; 1 the result is not usable, or cannot be written;\n"
         "2 wrong input or usage; 3 interrupted, the best result so far is\n"
         "written.\n";
}

std::string VersionText(const std::string& command) {
  return command.substr(command.find_last_of('/') + 1) + " " PINODE_VERSION;
}

}  // namespace pinode
