// Universal files read: text and binary data sets.

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <complex>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/compression.h"
#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/record/universal_file.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

constexpr size_t kLargestFile = size_t{4} << 30;

bool IsSeparator(std::string_view line) { return StripBlanks(line) == "-1"; }

// Lines of a text, and the bytes between them.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  bool AtEnd() const { return rest_.empty(); }
  // Without the line break; empty at the end.
  std::string_view Line() {
    const size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }
  std::string_view Peek() const {
    Reader copy = *this;
    return copy.Line();
  }
  std::string_view Bytes(size_t count) {
    const std::string_view bytes = rest_.substr(0, count);
    rest_.remove_prefix(bytes.size());
    return bytes;
  }
  size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

// Columns `begin` on of a line, stripped.
std::string_view Field(std::string_view line, size_t begin, size_t width) {
  return begin >= line.size() ? std::string_view()
                              : StripBlanks(line.substr(begin, width));
}

// A field of a fixed format: blank means zero.
bool IntField(std::string_view line, size_t begin, size_t width, int* value) {
  const std::string_view text = Field(line, begin, width);
  *value = 0;
  return text.empty() || ParseInt(text, value);
}
bool RealField(std::string_view line, size_t begin, size_t width,
               double* value) {
  const std::string_view text = Field(line, begin, width);
  *value = 0.0;
  return text.empty() || ParseDouble(text, value);
}

// Whether a number ends before the sign at `at`: fields may be full to the last
// column, and numbers touch.
bool BeginsNumber(std::string_view line, size_t at) {
  const unsigned char before = static_cast<unsigned char>(line[at - 1]);
  return (line[at] == '-' || line[at] == '+') &&
         (std::isdigit(before) || before == '.');
}

// The numbers of a line.
bool Numbers(std::string_view line, std::vector<double>* values) {
  size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() &&
           std::isspace(static_cast<unsigned char>(line[at]))) {
      ++at;
    }
    size_t end = at;
    while (end < line.size() &&
           !std::isspace(static_cast<unsigned char>(line[end])) &&
           (end == at || !BeginsNumber(line, end))) {
      ++end;
    }
    if (end == at) break;
    double value = 0.0;
    if (!ParseDouble(line.substr(at, end - at), &value)) return false;
    values->push_back(value);
    at = end;
  }
  return true;
}

bool ToInteger(double number, int* value) {
  if (!(number == std::floor(number) && std::abs(number) <= 2e9)) return false;
  *value = static_cast<int>(number);
  return true;
}

// As above, integers.
bool Integers(std::string_view line, std::vector<int>* values) {
  std::vector<double> numbers;
  if (!Numbers(line, &numbers)) return false;
  for (const double number : numbers) {
    int value = 0;
    if (!ToInteger(number, &value)) return false;
    values->push_back(value);
  }
  return true;
}

// Whether `numbers` are `expected`, but for rounding.
bool AreNear(const std::vector<double>& numbers,
             const std::vector<double>& expected) {
  return numbers.size() >= expected.size() &&
         std::equal(expected.begin(), expected.end(), numbers.begin(),
                    [](double a, double b) { return std::abs(a - b) < 1e-6; });
}

std::string Text(std::string_view line) {
  return std::string(StripBlanks(line));
}

// One data set at a time.
class Parser {
 public:
  Parser(const std::string& bytes, UniversalFile* file)
      : in_(bytes), file_(file) {}

  bool Parse(std::string* what) {
    while (!in_.AtEnd()) {
      if (!IsSeparator(in_.Line())) continue;
      if (in_.AtEnd()) break;
      const std::string header(in_.Line());
      const std::string_view name = Field(header, 0, 7);
      const bool binary =
          !name.empty() &&
          std::tolower(static_cast<unsigned char>(name.back())) == 'b';
      int type = 0;
      if (!ParseInt(binary ? name.substr(0, name.size() - 1) : name, &type)) {
        *what = "'" + Text(header) + "' is no type of a data set";
        return false;
      }
      file_->set_types.push_back(type);
      if (!ParseSet(type, binary, header, what)) {
        *what = "data set " + std::to_string(file_->set_types.size()) +
                " (type " + std::to_string(type) + "): " + *what;
        return false;
      }
    }
    if (!file_->set_types.empty()) return true;
    *what = "holds no data set, expected a universal file";
    return false;
  }

 private:
  bool ParseSet(int type, bool binary, const std::string& header,
                std::string* what) {
    switch (type) {
      case 58:
        return ParseFunction(binary, header, what);
      case 15:
        return ParseNodes(1, what);
      case 2411:
        return ParseNodes(2, what);
      case 18:
        ParseSystems();
        return true;
      case 2420:
        ParseSystemMatrices();
        return true;
      case 82:
        return ParseLine(what);
      case 2412:
        return ParseElements(what);
      case 55:
        return ParseShape(what);
      default:
        SkipSet();
        return true;
    }
  }

  void SkipSet() {
    while (!in_.AtEnd() && !IsSeparator(in_.Line())) {
    }
  }

  bool EndOfSet(std::string* what) {
    if (!in_.AtEnd() && IsSeparator(in_.Line())) return true;
    *what = "it does not end with -1";
    return false;
  }

  template <size_t kSize>
  void Texts(std::array<std::string, kSize>* texts) {
    for (std::string& text : *texts) text = Text(in_.Line());
  }

  bool ParseFunction(bool binary, const std::string& header,
                     std::string* what) {
    UniversalFunction f;
    Texts(&f.texts);
    const std::string_view names = in_.Line();
    const std::string_view sizes = in_.Line();
    int data_type = 0;
    int count = 0;
    int even = 0;
    *what = "its header is not that of a function";
    if (!IntField(names, 0, 5, &f.function_type) ||
        !IntField(names, 41, 10, &f.response_node) ||
        !IntField(names, 51, 4, &f.response_direction) ||
        !IntField(names, 66, 10, &f.reference_node) ||
        !IntField(names, 76, 4, &f.reference_direction) ||
        !IntField(sizes, 0, 10, &data_type) ||
        !IntField(sizes, 10, 10, &count) || !IntField(sizes, 20, 10, &even) ||
        !RealField(sizes, 30, 13, &f.abscissa_start) ||
        !RealField(sizes, 43, 13, &f.abscissa_step)) {
      return false;
    }
    int ignored = 0;
    for (int axis = 0; axis < 4; ++axis) {
      const std::string_view line = in_.Line();
      if (axis > 1) continue;
      std::string* label = axis == 0 ? &f.abscissa_label : &f.ordinate_label;
      std::string* unit = axis == 0 ? &f.abscissa_unit : &f.ordinate_unit;
      *label = std::string(Field(line, 26, 20));
      *unit = std::string(Field(line, 47, 20));
      if (!IntField(line, 0, 10, axis == 1 ? &f.ordinate_type : &ignored)) {
        return false;
      }
    }
    f.is_complex = data_type == 5 || data_type == 6;
    f.is_double = data_type == 4 || data_type == 6;
    if (!(data_type == 2 || f.is_complex || f.is_double) || count < 1) {
      *what = "its data are of type " + std::to_string(data_type) + ", " +
              std::to_string(count) + " of them, expected 2, 4, 5 or 6";
      return false;
    }
    if (even != 1) f.abscissa_step = 0.0;
    const size_t width = (f.is_complex ? 2u : 1u) + (even == 1 ? 0u : 1u);
    std::vector<double> numbers;
    const size_t wanted = static_cast<size_t>(count) * width;
    if (!(binary ? ReadBinary(header, f, even == 1, wanted, &numbers, what)
                 : ReadText(wanted, &numbers, what)) ||
        !EndOfSet(what)) {
      return false;
    }
    f.values.resize(count);
    if (even != 1) f.abscissa.resize(count);
    for (int i = 0; i < count; ++i) {
      const double* at = numbers.data() + static_cast<size_t>(i) * width;
      if (even != 1) f.abscissa[i] = *at++;
      f.values[i] = Complex(at[0], f.is_complex ? at[1] : 0.0);
    }
    file_->functions.push_back(std::move(f));
    return true;
  }

  bool ReadText(size_t wanted, std::vector<double>* numbers,
                std::string* what) {
    while (numbers->size() < wanted) {
      if (in_.AtEnd() || IsSeparator(in_.Peek())) {
        *what = "it has " + std::to_string(numbers->size()) +
                " numbers, its header says " + std::to_string(wanted);
        return false;
      }
      const std::string_view line = in_.Line();
      if (!Numbers(line, numbers)) {
        *what = "'" + Text(line) + "' is not a line of numbers";
        return false;
      }
    }
    if (numbers->size() == wanted) return true;
    *what = "it has more numbers than its header says";
    return false;
  }

  bool ReadBinary(const std::string& header, const UniversalFunction& f,
                  bool even, size_t wanted, std::vector<double>* numbers,
                  std::string* what) {
    std::vector<int> fields;
    if (!Integers(Field(header, 7, header.size()), &fields) ||
        fields.size() < 4 || fields[1] != 2 ||
        (fields[0] != 1 && fields[0] != 2)) {
      *what = "its bytes are not IEEE numbers in a known order";
      return false;
    }
    if (!even && f.is_double) {
      *what = "uneven binary data in double precision are not read";
      return false;
    }
    const size_t size = f.is_double ? 8 : 4;
    if (fields[3] < 0 || static_cast<size_t>(fields[3]) < wanted * size ||
        in_.left() < static_cast<size_t>(fields[3])) {
      *what = "it holds fewer bytes than its header says";
      return false;
    }
    const std::string_view bytes = in_.Bytes(static_cast<size_t>(fields[3]));
    const bool swap = fields[0] == 2;
    numbers->reserve(wanted);
    for (size_t i = 0; i < wanted; ++i) {
      unsigned char raw[8];
      std::memcpy(raw, bytes.data() + i * size, size);
      if (swap) std::reverse(raw, raw + size);
      if (f.is_double) {
        double value;
        std::memcpy(&value, raw, 8);
        numbers->push_back(value);
      } else {
        float value;
        std::memcpy(&value, raw, 4);
        numbers->push_back(value);
      }
    }
    // The separator begins a line of its own, with or without a break before.
    if (!in_.AtEnd() && StripBlanks(in_.Peek()).empty()) in_.Line();
    return true;
  }

  // Of label and position on one line, or on two.
  bool ParseNodes(int lines, std::string* what) {
    while (!in_.AtEnd() && !IsSeparator(in_.Peek())) {
      std::vector<double> numbers;
      std::string text;
      for (int i = 0; i < lines; ++i) text += std::string(in_.Line()) + " ";
      UniversalNode node;
      if (!Numbers(text, &numbers) || numbers.size() < 7 ||
          !ToInteger(numbers[0], &node.label) ||
          !ToInteger(numbers[1], &node.system) ||
          !ToInteger(numbers[2], &node.displacement_system)) {
        *what = "'" + Text(text) + "' is no node";
        return false;
      }
      node.position = {numbers[4], numbers[5], numbers[6]};
      file_->nodes.push_back(node);
    }
    return EndOfSet(what);
  }

  // The lines of a set, behind which its separator is.
  std::vector<std::string_view> LinesOfSet() {
    std::vector<std::string_view> lines;
    while (!in_.AtEnd()) {
      const std::string_view line = in_.Line();
      if (IsSeparator(line)) break;
      lines.push_back(line);
    }
    return lines;
  }

  // Of each: number, type, reference and more; name; origin and a point of the
  // x axis; a point of the x-z plane. What cannot be read is not the global
  // system, and no error where nobody asks for it.
  void ParseSystems() {
    const std::vector<std::string_view> lines = LinesOfSet();
    for (size_t i = 0; i + 3 < lines.size(); i += 4) {
      std::vector<int> head;
      std::vector<double> points;
      if (!Integers(lines[i], &head) || head.size() < 3) return;
      const bool good = Numbers(lines[i + 2], &points) &&
                        Numbers(lines[i + 3], &points) && points.size() >= 9;
      file_->systems[head[0]] = good && head[1] == 0 && head[2] == 0 &&
                                AreNear(points, {0.0, 0.0, 0.0}) &&
                                points[3] > 0.0 && points[8] > 0.0 &&
                                std::abs(points[4]) < 1e-6 * points[3] &&
                                std::abs(points[5]) < 1e-6 * points[3] &&
                                std::abs(points[7]) < 1e-6 * points[8];
    }
  }

  // Number and name of a part; of each system number, type and color; name;
  // three axes and the origin.
  void ParseSystemMatrices() {
    const std::vector<std::string_view> lines = LinesOfSet();
    for (size_t i = 2; i + 5 < lines.size(); i += 6) {
      std::vector<int> head;
      std::vector<double> axes;
      if (!Integers(lines[i], &head) || head.size() < 2) return;
      bool good = true;
      for (size_t k = 2; k < 6; ++k)
        good = good && Numbers(lines[i + k], &axes);
      file_->systems[head[0]] = good && head[1] == 0 &&
                                AreNear(axes, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0,
                                               0.0, 0.0, 1.0, 0.0, 0.0, 0.0});
    }
  }

  bool ParseLine(std::string* what) {
    std::vector<int> head;
    UniversalLine line;
    if (!Integers(in_.Line(), &head) || head.size() < 2) {
      *what = "it does not begin with the number of its nodes";
      return false;
    }
    line.name = Text(in_.Line());
    while (!in_.AtEnd() && !IsSeparator(in_.Peek())) {
      const std::string_view nodes = in_.Line();
      if (!Integers(nodes, &line.nodes)) {
        *what = "'" + Text(nodes) + "' is not a line of nodes";
        return false;
      }
    }
    // Some fill the last line with zeros.
    while (static_cast<int>(line.nodes.size()) > std::max(0, head[1]) &&
           line.nodes.back() == 0) {
      line.nodes.pop_back();
    }
    if (static_cast<int>(line.nodes.size()) != head[1]) {
      *what = "it has " + std::to_string(line.nodes.size()) +
              " nodes, its header says " + std::to_string(head[1]);
      return false;
    }
    file_->lines.push_back(std::move(line));
    return EndOfSet(what);
  }

  // As closed lines through their nodes; beams as they are.
  bool ParseElements(std::string* what) {
    while (!in_.AtEnd() && !IsSeparator(in_.Peek())) {
      std::vector<int> head;
      if (!Integers(in_.Line(), &head) || head.size() < 6 || head[5] < 1) {
        *what = "an element does not begin with six numbers";
        return false;
      }
      const bool beam = head[1] == 11 || (head[1] >= 21 && head[1] <= 24);
      if (beam) in_.Line();
      UniversalLine line;
      line.name = "element " + std::to_string(head[0]);
      while (static_cast<int>(line.nodes.size()) < head[5]) {
        if (in_.AtEnd() || IsSeparator(in_.Peek()) ||
            !Integers(in_.Line(), &line.nodes)) {
          *what = line.name + " has too few nodes";
          return false;
        }
      }
      if (!beam && line.nodes.size() > 2) {
        line.nodes.push_back(line.nodes.front());
      }
      file_->lines.push_back(std::move(line));
    }
    return EndOfSet(what);
  }

  bool ParseShape(std::string* what) {
    UniversalShape shape;
    Texts(&shape.texts);
    std::vector<int> head;
    std::vector<int> integers;
    std::vector<double> reals;
    *what = "its header is not that of data at nodes";
    if (!Integers(in_.Line(), &head) || head.size() < 6) return false;
    const std::string_view specific = in_.Line();
    if (!Integers(specific, &integers) || integers.size() < 2) return false;
    const size_t num_integers = static_cast<size_t>(std::max(0, integers[0]));
    const size_t num_reals = static_cast<size_t>(std::max(0, integers[1]));
    while (integers.size() < 2 + num_integers) {
      if (in_.AtEnd() || IsSeparator(in_.Peek()) ||
          !Integers(in_.Line(), &integers)) {
        return false;
      }
    }
    while (reals.size() < num_reals) {
      if (in_.AtEnd() || IsSeparator(in_.Peek()) ||
          !Numbers(in_.Line(), &reals)) {
        return false;
      }
    }
    shape.analysis_type = head[1];
    shape.is_complex = head[4] == 5 || head[4] == 6;
    shape.values_per_node = head[5];
    if (shape.values_per_node < 1 || shape.values_per_node > 6) return false;
    const auto integer = [&integers](size_t i) {
      return i < integers.size() ? integers[i] : 0;
    };
    const auto real = [&reals](size_t i) {
      return i < reals.size() ? reals[i] : 0.0;
    };
    shape.load_case = integer(2);
    shape.mode = integer(3);
    if (shape.analysis_type == 3 || shape.analysis_type == 7) {
      shape.eigenvalue = Complex(real(0), real(1));
      shape.frequency = std::abs(real(1)) / kTwoPi;
    } else {
      shape.frequency = real(0);
      shape.modal_mass = real(1);
      shape.viscous_damping = real(2);
      shape.hysteretic_damping = real(3);
    }
    return ParseShapeValues(&shape, what) && EndOfSet(what) &&
           (file_->shapes.push_back(std::move(shape)), true);
  }

  bool ParseShapeValues(UniversalShape* shape, std::string* what) {
    const size_t width = static_cast<size_t>(shape->values_per_node) *
                         (shape->is_complex ? 2u : 1u);
    std::vector<double> all;
    while (!in_.AtEnd() && !IsSeparator(in_.Peek())) {
      std::vector<int> label;
      if (!Integers(in_.Line(), &label) || label.empty()) {
        *what = "a node's number is missing";
        return false;
      }
      std::vector<double> numbers;
      while (numbers.size() < width) {
        if (in_.AtEnd() || IsSeparator(in_.Peek()) ||
            !Numbers(in_.Line(), &numbers)) {
          *what = "node " + std::to_string(label[0]) + " has too few numbers";
          return false;
        }
      }
      shape->nodes.push_back(label[0]);
      all.insert(all.end(), numbers.begin(),
                 numbers.begin() + static_cast<long>(width));
    }
    shape->values.resize(static_cast<Eigen::Index>(shape->nodes.size()),
                         shape->values_per_node);
    size_t at = 0;
    for (Eigen::Index row = 0; row < shape->values.rows(); ++row) {
      for (Eigen::Index k = 0; k < shape->values.cols(); ++k) {
        const double re = all[at++];
        shape->values(row, k) =
            Complex(re, shape->is_complex ? all[at++] : 0.0);
      }
    }
    return true;
  }

  Reader in_;
  UniversalFile* file_;
};

}  // namespace

bool UniversalFile::IsGlobal(int system) const {
  const auto place = systems.find(system);
  return place == systems.end() ? system == 0 || system == 1 : place->second;
}

bool ParseUniversalFile(const std::string& bytes, const std::string& path,
                        UniversalFile* file, std::string* error) {
  UniversalFile result;
  std::string what;
  if (!Parser(bytes, &result).Parse(&what)) {
    *error = path + ": " + what;
    return false;
  }
  *file = std::move(result);
  return true;
}

bool ReadUniversalFile(const std::string& path, UniversalFile* file,
                       std::string* error) {
  std::string bytes;
  if (!ReadBinaryFile(path, &bytes, error)) return false;
  if (WithoutGz(path) != path) {
    std::string unpacked;
    std::string what;
    if (!Unpack(CompressedFormat::kGzip, bytes, kLargestFile, &unpacked,
                &what)) {
      *error = path + ": " + what;
      return false;
    }
    bytes = std::move(unpacked);
  }
  return ParseUniversalFile(bytes, path, file, error);
}

}  // namespace pinode
