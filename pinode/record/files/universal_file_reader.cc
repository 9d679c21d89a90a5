// Reads universal files: data sets one after the other, and shapes.

#include <algorithm>
#include <array>
#include <cctype>
#include <complex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/compression.h"
#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/base/unpacked_size.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/record/files/universal_sets.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

bool ParseShapeValues(UniversalLines* in, UniversalShape* shape,
                      std::string* what) {
  const size_t width = static_cast<size_t>(shape->values_per_node) *
                       (shape->is_complex ? 2u : 1u);
  std::vector<double> all;
  while (!in->AtEndOfSet()) {
    std::vector<int> label;
    if (!UniversalIntegers(in->Next(), &label) || label.empty()) {
      *what = "a node's number is missing";
      return false;
    }
    std::vector<double> numbers;
    while (numbers.size() < width) {
      if (in->AtEndOfSet() || !UniversalNumbers(in->Next(), &numbers)) {
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
      shape->values(row, k) = Complex(re, shape->is_complex ? all[at++] : 0.0);
    }
  }
  return true;
}

bool ParseSet(int type, bool binary, const std::string& header,
              UniversalLines* in, UniversalFile* file, std::string* what) {
  switch (type) {
    case 58:
      return ParseUniversalFunction(binary, header, in, file, what);
    case 15:
      return ParseUniversalNodes(1, in, file, what);
    case 2411:
      return ParseUniversalNodes(2, in, file, what);
    case 18:
      ParseUniversalSystems(in, file);
      return true;
    case 2420:
      ParseUniversalSystemMatrices(in, file);
      return true;
    case 82:
      return ParseUniversalLine(in, file, what);
    case 2412:
      return ParseUniversalElements(in, file, what);
    case 55:
      return ParseUniversalShape(in, file, what);
    default:
      while (!in->AtEnd() && !IsUniversalSeparator(in->Next())) {
      }
      return true;
  }
}

bool ParseSets(const std::string& bytes, UniversalFile* file,
               std::string* what) {
  UniversalLines in(bytes);
  while (!in.AtEnd()) {
    if (!IsUniversalSeparator(in.Next())) continue;
    if (in.AtEnd()) break;
    const std::string header(in.Next());
    const std::string_view name = UniversalField(header, 0, 7);
    const bool binary =
        !name.empty() &&
        std::tolower(static_cast<unsigned char>(name.back())) == 'b';
    int type = 0;
    if (!ParseInt(binary ? name.substr(0, name.size() - 1) : name, &type)) {
      *what = "'" + std::string(StripBlanks(header)) +
              "' is not a type of data set";
      return false;
    }
    file->set_types.push_back(type);
    if (!ParseSet(type, binary, header, &in, file, what)) {
      *what = "data set " + std::to_string(file->set_types.size()) + " (type " +
              std::to_string(type) + "): " + *what;
      return false;
    }
  }
  if (!file->set_types.empty()) return true;
  *what = "holds no data set, expected a universal file";
  return false;
}

}  // namespace

bool EndUniversalSet(UniversalLines* in, std::string* what) {
  if (!in->AtEnd() && IsUniversalSeparator(in->Next())) return true;
  *what = "it does not end with -1";
  return false;
}

void ReadUniversalTexts(UniversalLines* in, std::array<std::string, 5>* texts) {
  for (std::string& text : *texts) {
    text = UniversalTextField(in->Next(), 0, std::string_view::npos);
  }
}

bool ParseUniversalShape(UniversalLines* in, UniversalFile* file,
                         std::string* what) {
  UniversalShape shape;
  ReadUniversalTexts(in, &shape.texts);
  std::vector<int> head;
  std::vector<int> integers;
  std::vector<double> reals;
  *what = "its header is not that of data at nodes";
  if (!UniversalIntegers(in->Next(), &head) || head.size() < 6) return false;
  const std::string_view specific = in->Next();
  if (!UniversalIntegers(specific, &integers) || integers.size() < 2)
    return false;
  const size_t num_integers = static_cast<size_t>(std::max(0, integers[0]));
  const size_t num_reals = static_cast<size_t>(std::max(0, integers[1]));
  while (integers.size() < 2 + num_integers) {
    if (in->AtEndOfSet() || !UniversalIntegers(in->Next(), &integers)) {
      return false;
    }
  }
  while (reals.size() < num_reals) {
    if (in->AtEndOfSet() || !UniversalNumbers(in->Next(), &reals)) {
      return false;
    }
  }
  shape.model_type = head[0];
  shape.analysis_type = head[1];
  shape.characteristic = head[2];
  shape.quantity = head[3];
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
    shape.modal_a = Complex(real(2), real(3));
    shape.modal_b = Complex(real(4), real(5));
  } else {
    shape.frequency = real(0);
    shape.modal_mass = real(1);
    shape.viscous_damping = real(2);
    shape.hysteretic_damping = real(3);
  }
  return ParseShapeValues(in, &shape, what) && EndUniversalSet(in, what) &&
         (file->shapes.push_back(std::move(shape)), true);
}

bool ParseUniversalFile(const std::string& bytes, const std::string& path,
                        UniversalFile* file, std::string* error) {
  UniversalFile result;
  std::string what;
  if (!ParseSets(bytes, &result, &what)) {
    *error = path + ": " + what;
    return false;
  }
  for (UniversalNode& node : result.nodes) {
    if (result.IsGlobal(node.system)) node.position_is_local = false;
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
    const UnpackedSize memory(static_cast<double>(bytes.size()));
    if (!Unpack(CompressedFormat::kGzip, bytes,
                static_cast<size_t>(memory.largest()), &unpacked, &what)) {
      *error = path + ": " + what;
      return false;
    }
    bytes = std::move(unpacked);
  }
  return ParseUniversalFile(bytes, path, file, error);
}

}  // namespace pinode
