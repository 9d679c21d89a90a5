// Reads data set 58: functions, as text and binary.

#include <algorithm>
#include <array>
#include <complex>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/record/files/universal_sets.h"

namespace pinode {
namespace {

constexpr char kNoteBegin[] = "abscissa from ";
constexpr char kNoteMiddle[] = " by ";

// Layout of the numbers, from the header.
struct Layout {
  int count = 0;  // of points
  bool is_even = true;
  size_t ordinates = 1;  // numbers of a point besides its abscissa
  size_t numbers() const {
    return static_cast<size_t>(count) * (ordinates + (is_even ? 0u : 1u));
  }
};

bool ReadAxis(std::string_view line, UniversalAxis* axis) {
  axis->label = UniversalTextField(line, 26, 20);
  axis->unit = UniversalTextField(line, 47, 20);
  return UniversalIntField(line, 0, 10, &axis->type) &&
         UniversalIntField(line, 10, 5, &axis->exponents[0]) &&
         UniversalIntField(line, 15, 5, &axis->exponents[1]) &&
         UniversalIntField(line, 20, 5, &axis->exponents[2]);
}

// Takes start and step from the text with all their digits, if it agrees with
// the columns.
void TakeAbscissaNote(std::string_view columns, UniversalFunction* f) {
  for (std::string& text : f->texts) {
    const size_t middle = text.find(kNoteMiddle);
    double start = 0.0;
    double step = 0.0;
    if (text.rfind(kNoteBegin, 0) != 0 || middle == std::string::npos) continue;
    const size_t begin = sizeof(kNoteBegin) - 1;
    const std::string_view view = text;
    if (!ParseDouble(view.substr(begin, middle - begin), &start) ||
        !ParseDouble(view.substr(middle + sizeof(kNoteMiddle) - 1), &step) ||
        UniversalNumber(start, 13) + UniversalNumber(step, 13) != columns) {
      continue;
    }
    f->abscissa_start = start;
    f->abscissa_step = step;
    text.clear();
    return;
  }
}

bool ReadHeader(UniversalLines* in, UniversalFunction* f, Layout* layout,
                std::string* what) {
  ReadUniversalTexts(in, &f->texts);
  const std::string_view names = in->Next();
  const std::string_view sizes = in->Next();
  int data_type = 0;
  int even = 0;
  f->response_name = UniversalTextField(names, 31, 10);
  f->reference_name = UniversalTextField(names, 56, 10);
  *what = "its header is not that of a function";
  if (!UniversalIntField(names, 0, 5, &f->function_type) ||
      !UniversalIntField(names, 5, 10, &f->number) ||
      !UniversalIntField(names, 15, 5, &f->version) ||
      !UniversalIntField(names, 20, 10, &f->load_case) ||
      !UniversalIntField(names, 41, 10, &f->response_node) ||
      !UniversalIntField(names, 51, 4, &f->response_direction) ||
      !UniversalIntField(names, 66, 10, &f->reference_node) ||
      !UniversalIntField(names, 76, 4, &f->reference_direction) ||
      !UniversalIntField(sizes, 0, 10, &data_type) ||
      !UniversalIntField(sizes, 10, 10, &layout->count) ||
      !UniversalIntField(sizes, 20, 10, &even) ||
      !UniversalRealField(sizes, 30, 13, &f->abscissa_start) ||
      !UniversalRealField(sizes, 43, 13, &f->abscissa_step) ||
      !UniversalRealField(sizes, 56, 13, &f->z)) {
    return false;
  }
  for (UniversalAxis* axis : {&f->abscissa_axis, &f->ordinate_axis,
                              &f->denominator_axis, &f->z_axis}) {
    if (!ReadAxis(in->Next(), axis)) return false;
  }
  f->is_complex = data_type == 5 || data_type == 6;
  f->is_double = data_type == 4 || data_type == 6;
  if (!(data_type == 2 || f->is_complex || f->is_double) || layout->count < 1) {
    *what = "its data are of type " + std::to_string(data_type) + ", " +
            std::to_string(layout->count) + " of them, expected 2, 4, 5 or 6";
    return false;
  }
  layout->is_even = even == 1;
  layout->ordinates = f->is_complex ? 2 : 1;
  if (layout->is_even) {
    TakeAbscissaNote(sizes.substr(std::min<size_t>(30, sizes.size()), 26), f);
  } else {
    f->abscissa_step = 0.0;
  }
  return true;
}

bool ReadText(size_t wanted, UniversalLines* in, std::vector<double>* numbers,
              std::string* what) {
  while (numbers->size() < wanted) {
    if (in->AtEndOfSet()) {
      *what = "it has " + std::to_string(numbers->size()) +
              " numbers, its header says " + std::to_string(wanted);
      return false;
    }
    const std::string_view line = in->Next();
    if (!UniversalNumbers(line, numbers)) {
      *what =
          "'" + std::string(StripBlanks(line)) + "' is not a line of numbers";
      return false;
    }
  }
  if (numbers->size() == wanted) return true;
  *what = "it has more numbers than its header says";
  return false;
}

template <typename Real>
double FromBytes(const char* bytes, bool swap) {
  std::array<char, sizeof(Real)> raw;
  std::copy_n(bytes, raw.size(), raw.begin());
  if (swap) std::reverse(raw.begin(), raw.end());
  Real value;
  std::memcpy(&value, raw.data(), raw.size());
  return value;
}

double FromBytes(const char* bytes, size_t size, bool swap) {
  return size == 8 ? FromBytes<double>(bytes, swap)
                   : FromBytes<float>(bytes, swap);
}

// The separator starts its own line, with or without a break before.
void SkipBreak(UniversalLines* in) {
  if (!in->AtEnd() && StripBlanks(in->Peek()).empty()) in->Next();
}

bool EndsBehind(const UniversalLines& in, size_t bytes) {
  if (in.left() <= bytes) return false;
  UniversalLines rest = in.Behind(bytes);
  SkipBreak(&rest);
  return !rest.AtEnd() && IsUniversalSeparator(rest.Peek());
}

// Returns the bytes of an abscissa beside ordinates of eight bytes. The format
// has four, because its abscissae are always of single precision. Some programs
// write eight (pyuff does, and counts its bytes wrong). The number of bytes,
// and the place where the set ends, show which. 0: neither fits.
size_t AbscissaBytes(const Layout& layout, size_t stated,
                     const UniversalLines& in) {
  const auto total = [&layout](size_t abscissa) {
    return static_cast<size_t>(layout.count) *
           (abscissa + 8 * layout.ordinates);
  };
  for (const size_t abscissa : {4u, 8u}) {
    if (stated == total(abscissa) && in.left() >= stated) return abscissa;
  }
  for (const size_t abscissa : {4u, 8u}) {
    if (EndsBehind(in, total(abscissa))) return abscissa;
  }
  return 0;
}

bool ReadBinary(const std::string& header, const UniversalFunction& f,
                const Layout& layout, UniversalLines* in,
                std::vector<double>* numbers, std::string* what) {
  std::vector<int> fields;
  if (!UniversalIntegers(UniversalField(header, 7, header.size()), &fields) ||
      fields.size() < 4 || fields[1] != 2 ||
      (fields[0] != 1 && fields[0] != 2)) {
    *what = "its bytes are not IEEE numbers in a known order";
    return false;
  }
  const size_t size = f.is_double ? 8 : 4;
  size_t stated = fields[3] < 0 ? 0 : static_cast<size_t>(fields[3]);
  size_t abscissa = layout.is_even ? 0 : size;
  if (!layout.is_even && f.is_double) {
    abscissa = AbscissaBytes(layout, stated, *in);
  }
  const size_t total =
      static_cast<size_t>(layout.count) * (abscissa + size * layout.ordinates);
  if (stated < total && EndsBehind(*in, total)) stated = total;
  if (stated < total || in->left() < stated ||
      (abscissa == 0 && !layout.is_even)) {
    *what = "it holds fewer bytes than its header says";
    return false;
  }
  const std::string_view bytes = in->Bytes(stated);
  const bool swap = fields[0] == 2;
  const char* at = bytes.data();
  numbers->reserve(layout.numbers());
  for (int i = 0; i < layout.count; ++i) {
    if (abscissa > 0) numbers->push_back(FromBytes(at, abscissa, swap));
    at += abscissa;
    for (size_t k = 0; k < layout.ordinates; ++k, at += size) {
      numbers->push_back(FromBytes(at, size, swap));
    }
  }
  SkipBreak(in);
  return true;
}

}  // namespace

std::string UniversalAbscissaNote(double start, double step) {
  const auto fits = [](double value) {
    double read = 0.0;
    return ParseDouble(UniversalNumber(value, 13), &read) && read == value;
  };
  if (fits(start) && fits(step)) return "";
  return kNoteBegin + FormatNumber(start) + kNoteMiddle + FormatNumber(step);
}

bool ParseUniversalFunction(bool binary, const std::string& header,
                            UniversalLines* in, UniversalFile* file,
                            std::string* what) {
  UniversalFunction f;
  Layout layout;
  std::vector<double> numbers;
  if (!ReadHeader(in, &f, &layout, what) ||
      !(binary ? ReadBinary(header, f, layout, in, &numbers, what)
               : ReadText(layout.numbers(), in, &numbers, what)) ||
      !EndUniversalSet(in, what)) {
    return false;
  }
  f.values.resize(layout.count);
  if (!layout.is_even) f.abscissa.resize(layout.count);
  const double* at = numbers.data();
  for (int i = 0; i < layout.count; ++i) {
    if (!layout.is_even) f.abscissa[i] = *at++;
    f.values[i] =
        std::complex<double>(at[0], layout.ordinates == 2 ? at[1] : 0.0);
    at += layout.ordinates;
  }
  file->functions.push_back(std::move(f));
  return true;
}

}  // namespace pinode
