#include "pinode/dynamics/element_library.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/fnv.h"
#include "pinode/dynamics/own_element.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr char kSticky[] = R"(
#include "pinode/dynamics/own_element.h"

struct Sticky {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* result) const {
    using std::tanh;
    result[0] = p[0] * q[0] + p[1] * tanh(q[1] / p[2]);
  }
};

struct Maxwell {
  template <typename T>
  void operator()(const T* q, const T* z, const T* p, T* result) const {
    result[0] = p[0] * (q[0] - z[0]);
    result[1] = p[0] * (q[0] - z[0]) / p[1];
  }
};

PINODE_ELEMENTS(library) {
  pinode::AddElement<Sticky, 0, 3>(
      "sticky", {{"k", 1, -1, 0}, {"f", 1, 0, 0}, {"v0", 0, 1, -1, 1e-9}},
      library);
  pinode::AddElement<Maxwell, 1, 2>(
      "maxwell", {{"k", 1, -1, 0}, {"c", 1, -1, 1, 0.0, 1e9, 5.0}}, library);
}
)";

class ElementLibraryTest : public ::testing::Test {
 protected:
  // Returns the path of the library compiled from this source.
  std::string Compile(const std::string& name, const std::string& source) {
    const std::string path = folder_.Write(name + ".cc", source);
    const std::string made = folder_.Path(name + ".so");
    const std::string command =
        std::string(PINODE_CXX_COMPILER) + " -std=c++17 -O0 -shared -fPIC " +
        ElementCompilerFlags() + " -I" + PINODE_SOURCE_DIR + " -idirafter " +
        PINODE_EIGEN_DIR + " -idirafter " + PINODE_CERES_DIR + " -o " + made +
        " " + path;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return made;
  }

  std::string ErrorOf(const std::string& path) {
    ElementLibrary library;
    std::string error;
    EXPECT_FALSE(LoadElementLibrary(path, &library, &error));
    EXPECT_TRUE(library.elements().empty());
    return error;
  }

  TemporaryFolder folder_;
};

TEST_F(ElementLibraryTest, HasLawsWithDerivatives) {
  const std::string path = Compile("sticky", kSticky);
  ElementLibrary library;
  std::string error;
  ASSERT_TRUE(LoadElementLibrary(path, &library, &error)) << error;
  ASSERT_EQ(library.elements().size(), 2u);
  const ElementLibrary::Element* element = library.Find("sticky", &error);
  ASSERT_NE(element, nullptr) << error;
  EXPECT_EQ(element->parameters[2].name, "v0");
  EXPECT_EQ(element->parameters[2].lower, 1e-9);
  EXPECT_TRUE(std::isinf(element->parameters[1].upper));
  const auto law = element->create();
  EXPECT_EQ(law->num_features(), 2);
  EXPECT_EQ(law->num_internal(), 0);
  const double q[] = {0.5, -0.3};
  const double p[] = {10.0, 4.0, 0.2};
  double force = 0.0;
  double slopes[5];
  law->Linearize(q, nullptr, p, &force, slopes);
  EXPECT_DOUBLE_EQ(force, 5.0 - 4.0 * std::tanh(1.5));
  EXPECT_DOUBLE_EQ(slopes[0], 10.0);
  EXPECT_NEAR(slopes[1], 20.0 / std::pow(std::cosh(1.5), 2), 1e-14);
  EXPECT_DOUBLE_EQ(slopes[3], std::tanh(-1.5));
  const ElementLibrary::Element* maxwell = library.Find("maxwell", &error);
  ASSERT_NE(maxwell, nullptr);
  EXPECT_EQ(maxwell->create()->num_internal(), 1);
  EXPECT_EQ(maxwell->parameters[1].default_value, 5.0);
  EXPECT_TRUE(std::isnan(maxwell->parameters[0].default_value));
  EXPECT_FALSE(library.fingerprint().empty());
  EXPECT_EQ(library.Find("stiky", &error), nullptr);
  EXPECT_THAT(error, HasSubstr("expected one of 'sticky', 'maxwell'"));
}

TEST_F(ElementLibraryTest, RefusesInOneLine) {
  const std::string none = folder_.Path("none.so");
  EXPECT_EQ(ErrorOf(none), none +
                               ": cannot be opened, expected a shared "
                               "library");
  EXPECT_THAT(ErrorOf(folder_.Write("text.so", "no library\n")),
              HasSubstr("text.so: cannot be loaded: "));
  EXPECT_THAT(ErrorOf(Compile("empty", "int nothing() { return 0; }\n")),
              HasSubstr("has no elements"));
  EXPECT_THAT(ErrorOf(Compile("other", R"(
namespace pinode { class ElementLibrary; }
extern "C" unsigned long PinodeElementInterface() { return 7; }
extern "C" void PinodeElements(pinode::ElementLibrary*) {}
)")),
              HasSubstr("another version of pinode"));
}

// Returns the code of a header, without comments and spaces.
std::string CodeOf(const std::string& header) {
  std::string text, error;
  EXPECT_TRUE(
      ReadTextFile(std::string(PINODE_SOURCE_DIR "/pinode/dynamics/") + header,
                   &text, &error))
      << error;
  std::istringstream lines(text);
  std::string code;
  for (std::string line; std::getline(lines, line);) {
    line.erase(std::min(line.find("//"), line.size()));
    line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
    code += line;
  }
  return code;
}

// Libraries compiled earlier must be refused after a change of the headers that
// they use.
TEST(ElementInterface, IsCountedUpWithEveryChange) {
  const std::string code =
      CodeOf("law.h") + CodeOf("wide_jet.h") + CodeOf("element_library.h");
  EXPECT_EQ(Fnv1a(code.data(), code.size()), 13145188011388173144u)
      << "The interface to elements of one's own has another text: unless "
         "libraries compiled before can go on as they are, count kVersion in "
         "own_element.h up; then this figure is that of the new one.";
}

struct Spring {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* result) const {
    result[0] = p[0] * q[0] + p[1] * q[1];
  }
};

std::string WhyNotValid(std::vector<ElementParameterInfo> parameters) {
  ElementLibrary library;
  AddElement<Spring, 0, 2>("spring", std::move(parameters), &library);
  std::string error;
  EXPECT_FALSE(library.IsValid(&error));
  return error;
}

TEST(ElementLibrary, DescribesWhatItsLawsTake) {
  ElementLibrary library;
  AddElement<Spring, 0, 2>("spring", {{"k", 1, -1, 0}, {"c", 1, -1, 1}},
                           &library);
  std::string error;
  EXPECT_TRUE(library.IsValid(&error)) << error;
  EXPECT_THAT(WhyNotValid({{"k", 1, -1, 0}}),
              HasSubstr("'spring' has 2 parameters and describes 1"));
  const std::string own = "expected a unique name and limits";
  EXPECT_THAT(WhyNotValid({{"k", 1, -1, 0}, {"k", 1, -1, 1}}), HasSubstr(own));
  EXPECT_THAT(WhyNotValid({{"k", 1, -1, 0}, {"", 1, -1, 1}}), HasSubstr(own));
  EXPECT_THAT(WhyNotValid({{"k", 1, -1, 0}, {"c", 1, -1, 1, 2.0, 1.0}}),
              HasSubstr(own));
}

}  // namespace
}  // namespace pinode
