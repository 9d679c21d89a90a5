#include "pinode/structure/matrices/harwell_boeing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/fortran_text.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

class HarwellBoeingReader {
 public:
  HarwellBoeingReader(const std::string& path, const std::string& content,
                      int max_dimension, std::string* error)
      : lines_(path, content), max_dimension_(max_dimension), error_(error) {}

  bool Read(SparseMatrix* matrix) {
    if (!ReadCards() || !ReadType() || !ReadFormats()) return false;
    std::vector<int> begins;
    std::vector<int> rows;
    if (!ReadBegins(&begins) || !ReadRows(&rows)) return false;
    std::vector<MatrixEntry> entries;
    if (!ReadValues(begins, rows, &entries)) return false;
    MatrixEntry twice;
    if (AssembleMatrix(size_, size_, is_symmetric_, &entries, matrix, &twice)) {
      return true;
    }
    return lines_.FailAt(twice.line,
                         "entry " + EntryText(twice.row, twice.column) +
                             (is_symmetric_ ? " or its mirror image" : "") +
                             " was given before, expected each entry once",
                         error_);
  }

 private:
  bool Fail(const std::string& message) { return lines_.Fail(message, error_); }

  bool NextLine(const char* expected, std::string_view* line) {
    if (lines_.NextRaw(line)) return true;
    return Fail(std::string("the file ends here, expected ") + expected);
  }

  // Reads the title and the numbers of lines of each part. The numbers
  // only say if a fifth line of the header follows: one about right-hand sides.
  bool ReadCards() {
    std::string_view line;
    if (!NextLine("a title", &line)) return false;
    if (line.find('\0') != std::string_view::npos) {
      return Fail(
          "this is no text; expected the ASCII form (HBMAT, Fname, Ext, , "
          "ASCII)");
    }
    if (!NextLine("the numbers of lines of each part", &line)) return false;
    const std::vector<std::string_view> words = SplitBlanks(line);
    std::array<int, 5> cards = {};
    bool parsed = words.size() == 4 || words.size() == 5;
    for (size_t i = 0; parsed && i < words.size(); ++i) {
      parsed = ParseInt(words[i], &cards[i]) && cards[i] >= 0;
    }
    if (!parsed) {
      return Fail("the line is " + Quote(line) +
                  ", expected four or five numbers of lines, the second line "
                  "of a Harwell-Boeing file");
    }
    has_right_sides_ = cards[4] > 0;
    return true;
  }

  bool ReadType() {
    std::string_view line;
    if (!NextLine("the type and size of the matrix", &line)) return false;
    const std::vector<std::string_view> words = SplitBlanks(line);
    int columns = 0;
    if (words.size() < 4 || words[0].size() != 3 ||
        !ParseInt(words[1], &size_) || !ParseInt(words[2], &columns) ||
        !ParseInt(words[3], &num_entries_) || size_ < 1 || num_entries_ < 0) {
      return Fail("the line is " + Quote(line) +
                  ", expected 'type rows columns entries', such as 'RSA 4 4 "
                  "7'");
    }
    const std::string type = LowerCase(words[0]);
    if (type[0] == 'p' || type[0] == 'q') {
      return Fail("the type is " + Quote(words[0]) +
                  ", a pattern without values, expected RSA or RUA");
    }
    if (type[0] == 'c') {
      return Fail("the type is " + Quote(words[0]) +
                  ", a complex matrix, expected RSA or RUA: mass, damping and "
                  "stiffness are real");
    }
    if (type[2] == 'e') {
      return Fail("the type is " + Quote(words[0]) +
                  ", a matrix in pieces of elements, expected an assembled one "
                  "(RSA or RUA)");
    }
    if ((type[0] != 'r' && type[0] != 'i') ||
        (type[1] != 's' && type[1] != 'u') || type[2] != 'a') {
      return Fail("the type is " + Quote(words[0]) +
                  ", expected RSA (symmetric) or RUA (general)");
    }
    is_integer_ = type[0] == 'i';
    is_symmetric_ = type[1] == 's';
    if (size_ != columns) {
      return Fail("the matrix is " + SizeText(size_, columns) +
                  ", expected as many rows as columns");
    }
    if (size_ > max_dimension_) {
      return Fail("the matrix is " + SizeText(size_, columns) +
                  ", expected at most " + std::to_string(max_dimension_) +
                  " rows and columns");
    }
    const int64_t n = size_;
    if (num_entries_ > n * n) {
      return Fail(std::to_string(num_entries_) +
                  " entries are announced, expected at most " +
                  std::to_string(n * n));
    }
    return true;
  }

  bool ReadFormats() {
    std::string_view line;
    if (!NextLine("the formats of the numbers", &line)) return false;
    // Pointers and indices in 16 places each, values in 20.
    const std::string_view texts[] = {
        line.substr(0, 16),
        line.size() > 16 ? line.substr(16, 16) : std::string_view(),
        line.size() > 32 ? line.substr(32, 20) : std::string_view()};
    FortranFormat* const formats[] = {&begin_format_, &row_format_,
                                      &value_format_};
    for (int i = 0; i < 3; ++i) {
      if (!ParseFortranFormat(texts[i], formats[i]) ||
          (i < 2 ? formats[i]->letter != 'I'
                 : formats[i]->letter == 'I' && !is_integer_)) {
        return Fail("the format " + std::to_string(i + 1) + " is " +
                    Quote(StripBlanks(texts[i])) + ", expected one such as " +
                    (i < 2 ? "'(10I8)'" : "'(4E20.12)'"));
      }
    }
    return !has_right_sides_ ||
           NextLine("the line about right-hand sides", &line);
  }

  // Calls take(i, field) for `count` numbers.
  template <typename Take>
  bool ForEachField(int count, const FortranFormat& format,
                    const char* expected, const Take& take) {
    for (int done = 0; done < count;) {
      std::string_view line;
      if (!NextLine(expected, &line)) return false;
      const int here = std::min(format.count, count - done);
      // Numbers may touch each other, and then only the format parts them. But
      // SciPy's lines are narrower than the format that it states.
      const std::vector<std::string_view> words = SplitBlanks(line);
      const bool are_apart = words.size() == static_cast<size_t>(here);
      for (int i = 0; i < here; ++i) {
        if (!take(done + i, are_apart ? words[static_cast<size_t>(i)]
                                      : FixedField(line, i, format.width))) {
          return false;
        }
      }
      done += here;
    }
    return true;
  }

  bool ReadBegins(std::vector<int>* begins) {
    const auto take = [this, begins](int i, std::string_view field) {
      int begin = 0;
      const int least = begins->empty() ? 1 : begins->back() + 1;
      if (!ParseInt(field, &begin) || begin < least ||
          begin - 1 > num_entries_ || (i == 0 && begin != 1) ||
          (i == size_ && begin - 1 != num_entries_)) {
        return Fail("the beginning of column " + std::to_string(i + 1) +
                    " is " + Quote(field) +
                    ", expected positions that rise from 1 to " +
                    std::to_string(int64_t{num_entries_} + 1));
      }
      begins->push_back(begin - 1);
      return true;
    };
    return ForEachField(size_ + 1, begin_format_, "more beginnings of columns",
                        take);
  }

  bool ReadRows(std::vector<int>* rows) {
    const auto take = [this, rows](int i, std::string_view field) {
      int row = 0;
      if (!ParseInt(field, &row) || row < 1 || row > size_) {
        return Fail("row " + std::to_string(i + 1) + " of the list is " +
                    Quote(field) + ", expected one from 1 to " +
                    std::to_string(size_));
      }
      rows->push_back(row - 1);
      return true;
    };
    return ForEachField(num_entries_, row_format_, "more rows of entries",
                        take);
  }

  bool ReadValues(const std::vector<int>& begins, const std::vector<int>& rows,
                  std::vector<MatrixEntry>* entries) {
    int column = 0;
    const auto take = [&](int i, std::string_view field) {
      while (i >= begins[static_cast<size_t>(column) + 1]) ++column;
      MatrixEntry entry;
      entry.row = rows[static_cast<size_t>(i)];
      entry.column = column;
      entry.line = lines_.number();
      if (!ParseFortranDouble(field, &entry.value)) {
        return Fail("entry " + EntryText(entry.row, entry.column) + " is " +
                    Quote(field) + ", expected a number");
      }
      if (!std::isfinite(entry.value)) {
        return Fail("entry " + EntryText(entry.row, entry.column) + " is " +
                    Quote(field) + ", expected a finite number");
      }
      entries->push_back(entry);
      return true;
    };
    return ForEachField(num_entries_, value_format_, "more values", take);
  }

  LineReader lines_;
  const int max_dimension_;
  std::string* const error_;
  bool has_right_sides_ = false;
  bool is_integer_ = false;
  bool is_symmetric_ = false;
  int size_ = 0;
  int num_entries_ = 0;
  FortranFormat begin_format_;
  FortranFormat row_format_;
  FortranFormat value_format_;
};

}  // namespace

bool IsHarwellBoeing(const std::string& path) {
  const std::string extension =
      LowerCase(std::filesystem::path(WithoutGz(path)).extension().string());
  for (const char* known : {".hb", ".rb", ".rsa", ".rua", ".matrix"}) {
    if (extension == known) return true;
  }
  return false;
}

bool ReadHarwellBoeingText(const std::string& path, const std::string& content,
                           int max_dimension, SparseMatrix* matrix,
                           std::string* error) {
  CHECK(matrix != nullptr);
  CHECK(error != nullptr);
  return HarwellBoeingReader(path, content, max_dimension, error).Read(matrix);
}

bool ReadHarwellBoeing(const std::string& path, int max_dimension,
                       SparseMatrix* matrix, std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadHarwellBoeingText(path, content, max_dimension, matrix, error);
}

bool ReadRowMappingText(const std::string& path, const std::string& content,
                        std::vector<std::string>* names, std::string* error) {
  CHECK(names != nullptr);
  CHECK(error != nullptr);
  static const char* const kLabels[] = {"UX",   "UY",   "UZ",
                                        "ROTX", "ROTY", "ROTZ"};
  LineReader lines(path, content);
  std::vector<std::string> read;
  std::string_view line;
  while (lines.Next(&line)) {
    const std::vector<std::string_view> words = SplitBlanks(line);
    int row = 0;
    int node = 0;
    const bool is_row = words.size() == 3 && ParseInt(words[0], &row) &&
                        ParseInt(words[1], &node);
    if (!is_row && read.empty()) continue;  // blank lines and the title
    if (words.empty()) continue;
    if (!is_row || row < 1 || row > kMaxFiniteElementDofs || node < 1) {
      return lines.Fail("the line is " + Quote(line) +
                            ", expected 'row node direction', such as '1 12 "
                            "UX'",
                        error);
    }
    std::string direction(words[2]);
    for (int d = 0; d < 6; ++d) {
      if (direction == kLabels[d]) direction = std::to_string(d + 1);
    }
    const auto place = static_cast<size_t>(row);
    if (place > read.size()) read.resize(place);
    if (!read[place - 1].empty()) {
      return lines.Fail("row " + std::to_string(row) +
                            " was given before, expected each row once",
                        error);
    }
    read[place - 1] = std::to_string(node) + "." + direction;
  }
  if (read.empty()) {
    return lines.Fail("the file has no rows, expected 'row node direction'",
                      error);
  }
  for (size_t i = 0; i < read.size(); ++i) {
    if (!read[i].empty()) continue;
    return lines.Fail("row " + std::to_string(i + 1) +
                          " is missing, expected all rows up to " +
                          std::to_string(read.size()),
                      error);
  }
  names->swap(read);
  return true;
}

bool ReadRowMapping(const std::string& path, std::vector<std::string>* names,
                    std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ReadRowMappingText(path, content, names, error);
}

}  // namespace pinode
