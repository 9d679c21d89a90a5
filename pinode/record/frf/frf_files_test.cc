// Readers of frequency response functions.

#include "pinode/record/frf/frf_files.h"

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/record/files/universal_file.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using ::testing::HasSubstr;

bool Parse(const std::string& text, FrequencyResponse* response,
           std::string* error) {
  std::vector<std::string> remarks;
  return ParseFrfText(text, "f.txt", response, &remarks, error);
}

TEST(FrfFilesTest, ReadsRealAndImaginaryWithUnits) {
  FrequencyResponse one;
  std::string error;
  ASSERT_TRUE(
      Parse("Units: Ratio\r\nRef Chan:Resp Chan\t0-Z:0-Z\r\n\r\n"
            "Frequency\t Real\t Imaginary\r\n\r\nUnits:\r\n"
            "Hz\t(m/s\xb2)(N)\t \r\n"
            "0.0e+000\t -0.5\t 0\r\n1.5e+000\t 2\t -3\r\n",
            &one, &error))
      << error;
  EXPECT_EQ(one.derivative, 2);
  ASSERT_EQ(one.values.size(), 2);
  EXPECT_EQ(one.frequencies_hz[1], 1.5);
  EXPECT_EQ(one.values[1], Complex(2.0, -3.0));
}

TEST(FrfFilesTest, ReadsDecibelsAndDegrees) {
  FrequencyResponse one;
  std::string error;
  ASSERT_TRUE(Parse("Frequency\tMagnitude\tPhase\t\n1\t-20\t90\n2\t40\t-180\n",
                    &one, &error))
      << error;
  EXPECT_NEAR(std::abs(one.values[0] - Complex(0.0, 0.1)), 0.0, 1e-15);
  EXPECT_NEAR(std::abs(one.values[1] - Complex(-100.0, 0.0)), 0.0, 1e-12);
  EXPECT_EQ(one.derivative, -1);
}

TEST(FrfFilesTest, MalformedTextGivesOneLine) {
  const struct {
    const char* text;
    const char* message;
  } cases[] = {
      {"", "has no lines of numbers"},
      {"Frequency,Real\n1,2\n", "f.txt:1: the columns"},
      {"1 2 3\n", "f.txt:1: no header names the columns"},
      {"freq;real;imag\n1;2;3\n2;3\n", "f.txt:3: has 2 numbers, expected 3"},
      {"freq;real;imag\n1;2;3\n2;x;3\n", "f.txt:3:"},
  };
  for (const auto& bad : cases) {
    FrequencyResponse one;
    std::string error;
    EXPECT_FALSE(Parse(bad.text, &one, &error)) << bad.text;
    EXPECT_THAT(error, HasSubstr(bad.message));
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

UniversalFile Universal() {
  UniversalFile file;
  UniversalFunction f;
  f.function_type = 4;
  f.response_node = 3;
  f.response_direction = -3;
  f.reference_node = 1;
  f.reference_direction = 3;
  f.ordinate_axis.type = 12;
  f.denominator_axis.type = 13;
  f.abscissa_axis.type = 18;
  f.is_complex = true;
  f.abscissa_start = 2.0;
  f.abscissa_step = 0.5;
  f.values.resize(3);
  f.values << Complex(1.0, 2.0), Complex(3.0, -4.0), Complex(0.5, 0.25);
  file.functions.push_back(f);
  f.function_type = 6;
  f.is_complex = false;
  f.values = ComplexVector::Constant(3, Complex(0.9, 0.0));
  file.functions.push_back(f);
  return file;
}

bool ReadUniversal(const UniversalFile& file,
                   std::vector<FrequencyResponse>* all, std::string* error) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("frf.uff");
  std::vector<std::string> remarks;
  return WriteFileAtomically(path, FormatUniversalFile(file), error) &&
         ReadFrfFile(path, {}, all, &remarks, error);
}

TEST(FrfFilesTest, ReadsUniversalFiles) {
  std::vector<FrequencyResponse> all;
  std::string error;
  ASSERT_TRUE(ReadUniversal(Universal(), &all, &error)) << error;
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].response, "3:-z");
  EXPECT_EQ(all[0].reference, "1:z");
  EXPECT_EQ(all[0].derivative, 2);
  EXPECT_EQ(all[0].frequencies_hz, Vector::LinSpaced(3, 2.0, 3.0));
  EXPECT_EQ(all[0].values[1], Complex(3.0, -4.0));
  ASSERT_EQ(all[0].coherence.size(), 3);
  EXPECT_NEAR(all[0].coherence[2], 0.9, 1e-7);
  FrequencyResponses together;
  ASSERT_TRUE(AssembleFrequencyResponses(all, &together, &error)) << error;
  EXPECT_EQ(together.responses[0], "3:z");
  EXPECT_EQ(together.values(1, 0), Complex(-3.0, 4.0));
  EXPECT_EQ(together.variances.rows(), 3);
}

TEST(FrfFilesTest, UnevenAndUnsuitedUniversalFunctions) {
  UniversalFile file = Universal();
  file.functions[0].abscissa.resize(3);
  file.functions[0].abscissa << 1.0, 2.0, 4.0;
  std::vector<FrequencyResponse> all;
  std::string error;
  ASSERT_TRUE(ReadUniversal(file, &all, &error)) << error;
  EXPECT_EQ(all[0].frequencies_hz[2], 4.0);
  file = Universal();
  file.functions[0].denominator_axis.type = 12;
  EXPECT_FALSE(ReadUniversal(file, &all, &error));
  EXPECT_THAT(error, HasSubstr("no force as its reference"));
  file = Universal();
  file.functions[0].ordinate_axis.type = 15;
  EXPECT_FALSE(ReadUniversal(file, &all, &error));
  EXPECT_THAT(error, HasSubstr("is no motion"));
  file = Universal();
  file.functions[0].is_complex = false;
  EXPECT_FALSE(ReadUniversal(file, &all, &error));
  EXPECT_THAT(error, HasSubstr("real values only"));
  file = Universal();
  file.functions.erase(file.functions.begin());
  all.clear();
  EXPECT_FALSE(ReadUniversal(file, &all, &error));
  EXPECT_THAT(error, HasSubstr("holds no frequency response function"));
}

FrequencyResponse Single(const std::string& response,
                         const std::string& reference) {
  FrequencyResponse one;
  one.file = response + reference + ".uff";
  one.response = response;
  one.reference = reference;
  one.derivative = 2;
  one.frequencies_hz = Vector::LinSpaced(3, 1.0, 3.0);
  one.values = ComplexVector::Constant(3, Complex(1.0, 2.0));
  return one;
}

TEST(FrequencyResponsesTest, SignsOfPlacesAreSignsOfFunctions) {
  FrequencyResponses all;
  std::string error;
  ASSERT_TRUE(AssembleFrequencyResponses(
      {Single("1:-x", "2:y"), Single("3:z", "2:y")}, &all, &error))
      << error;
  EXPECT_EQ(all.responses, (std::vector<std::string>{"1:x", "3:z"}));
  EXPECT_EQ(all.values(0, 0), Complex(-1.0, -2.0));
  EXPECT_EQ(all.values(0, 1), Complex(1.0, 2.0));
}

// 2000 places that each have one function: a complete set would take 190 MB.
TEST(FrequencyResponsesTest, ManyPlacesWithoutTheirPairsTakeNoMemory) {
  std::vector<FrequencyResponse> single;
  for (int i = 0; i < 2000; ++i) {
    single.push_back(Single("a" + std::to_string(i), "b" + std::to_string(i)));
  }
  FrequencyResponses all;
  std::string error;
  EXPECT_FALSE(AssembleFrequencyResponses(single, &all, &error));
  EXPECT_THAT(error, HasSubstr("'a1' to reference 'b0' is missing"));
}

TEST(FrequencyResponsesTest, RefusesNumbersThatAreNone) {
  FrequencyResponses all;
  std::string error;
  FrequencyResponse endless = Single("a", "b");
  endless.frequencies_hz[endless.frequencies_hz.size() - 1] =
      std::numeric_limits<double>::infinity();
  EXPECT_FALSE(AssembleFrequencyResponses({endless}, &all, &error));
  FrequencyResponse unknown = Single("a", "b");
  unknown.coherence = Vector::Ones(unknown.values.size());
  unknown.coherence[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(AssembleFrequencyResponses({unknown}, &all, &error));
  EXPECT_THAT(error, HasSubstr("missing or infinite"));
}

TEST(FrequencyResponsesTest, IncompleteSetsAreNamed) {
  FrequencyResponses all;
  std::string error;
  EXPECT_FALSE(AssembleFrequencyResponses({}, &all, &error));
  EXPECT_FALSE(AssembleFrequencyResponses({Single("a", "b"), Single("a", "b")},
                                          &all, &error));
  EXPECT_THAT(error, HasSubstr("occurs twice"));
  EXPECT_FALSE(AssembleFrequencyResponses({Single("a", "a"), Single("b", "b")},
                                          &all, &error));
  EXPECT_THAT(error, HasSubstr("'b' to reference 'a' is missing"));
  FrequencyResponse other = Single("c", "b");
  other.derivative = 0;
  EXPECT_FALSE(
      AssembleFrequencyResponses({Single("a", "b"), other}, &all, &error));
  EXPECT_THAT(error, HasSubstr("receptance"));
  other = Single("c", "b");
  other.frequencies_hz[2] = 3.5;
  EXPECT_FALSE(
      AssembleFrequencyResponses({Single("a", "b"), other}, &all, &error));
  EXPECT_THAT(error, HasSubstr("its lines are not those of"));
  other = Single("a", "b");
  other.frequencies_hz.tail(1)[0] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(AssembleFrequencyResponses({other}, &all, &error));
  EXPECT_THAT(error, HasSubstr("a frequency is infinite; leave its line out"));
  other = Single("", "b");
  EXPECT_FALSE(AssembleFrequencyResponses({other}, &all, &error));
  EXPECT_THAT(error, HasSubstr("set responses"));
}

// A later header counts. Its fewer columns once left places of the first.
TEST(FrfFilesTest, ASecondHeaderReplacesTheFirst) {
  FrequencyResponse one;
  std::string error;
  ASSERT_TRUE(Parse("freq;name;magnitude;phase\nfreq;real;imag\n1;2;3\n2;4;5\n",
                    &one, &error))
      << error;
  EXPECT_EQ(one.values[1], Complex(4.0, 5.0));
  EXPECT_FALSE(
      Parse("freq;name;magnitude;phase\nfreq;imag\n1;2;3;4\n", &one, &error));
  EXPECT_THAT(error, HasSubstr("f.txt:2: the columns"));
}

// Scalars have direction 0, and some programs number more than six.
TEST(FrfFilesTest, UniversalPlacesOfAnyDirection) {
  UniversalFile file = Universal();
  file.functions[0].response_direction = 0;
  file.functions[0].reference_direction = -12;
  std::vector<FrequencyResponse> all;
  std::string error;
  ASSERT_TRUE(ReadUniversal(file, &all, &error)) << error;
  EXPECT_EQ(all[0].response, "3");
  EXPECT_EQ(all[0].reference, "1:-12");
}

// Written functions come back with places of any length, coherence and window.
TEST(FrfFilesTest, WrittenFunctionsAreReadBack) {
  FrequencyResponses all;
  all.responses = {"12:-x", "deck_north_east_z"};
  all.references = {"deck_north_east_y"};
  all.derivative = 1;
  all.decay_rate = 1.0 / 0.3;
  all.frequencies_hz = Vector::LinSpaced(5, 0.1, 0.5);
  all.values.resize(5, 2);
  all.coherence.resize(5, 2);
  for (int k = 0; k < 5; ++k) {
    all.values.row(k) << Complex(k, 1.0 / 3.0), Complex(-k, 1e-7);
    all.coherence.row(k) << 0.1 * k + 0.3, 0.9;
  }
  const TemporaryFolder folder;
  const std::string path = folder.Path("frf.uff");
  std::string error;
  ASSERT_TRUE(WriteFileAtomically(path, FormatFrfFile(all, "m/s", "N"), &error))
      << error;
  std::vector<FrequencyResponse> single;
  std::vector<std::string> remarks;
  ASSERT_TRUE(ReadFrfFile(path, {}, &single, &remarks, &error)) << error;
  FrequencyResponses read;
  ASSERT_TRUE(AssembleFrequencyResponses(single, &read, &error)) << error;
  // A sign of a direction goes into the values.
  EXPECT_THAT(read.responses,
              ::testing::ElementsAre("12:x", "deck_north_east_z"));
  EXPECT_THAT(read.references, ::testing::ElementsAre("deck_north_east_y"));
  EXPECT_EQ(read.derivative, 1);
  EXPECT_EQ(read.decay_rate, all.decay_rate);
  EXPECT_LT((read.frequencies_hz - all.frequencies_hz).norm(), 1e-12);
  EXPECT_EQ(ComplexVector(read.values.col(0)),
            ComplexVector(-all.values.col(0)));
  EXPECT_EQ(ComplexVector(read.values.col(1)),
            ComplexVector(all.values.col(1)));
  EXPECT_LT((read.coherence - all.coherence).norm(), 1e-12);
  EXPECT_LT((read.variances - VariancesOfCoherence(read.values, read.coherence))
                .norm(),
            1e-12);
  single[1].decay_rate = 0.0;
  EXPECT_FALSE(AssembleFrequencyResponses(single, &read, &error));
  EXPECT_THAT(error, HasSubstr("another exponential window"));
}

// Names that are alike in the 10 characters of the format keep their coherence.
TEST(FrfFilesTest, LongNamesAreToldApart) {
  FrequencyResponses all;
  all.responses = {"acceleration_1", "acceleration_2", "deck left A",
                   "deck left B"};
  all.references = {"hammer"};
  all.frequencies_hz = Vector::LinSpaced(3, 1.0, 3.0);
  all.values = ComplexMatrix::Ones(3, 4);
  all.coherence.resize(3, 4);
  all.coherence.rowwise() = Eigen::RowVector4d(0.6, 0.7, 0.8, 0.9);
  const TemporaryFolder folder;
  const std::string path = folder.Path("frf.uff");
  std::string error;
  ASSERT_TRUE(
      WriteFileAtomically(path, FormatFrfFile(all, "m/s^2", "N"), &error))
      << error;
  std::vector<FrequencyResponse> single;
  std::vector<std::string> remarks;
  ASSERT_TRUE(ReadFrfFile(path, {}, &single, &remarks, &error)) << error;
  ASSERT_EQ(single.size(), 4u);
  for (size_t i = 0; i < single.size(); ++i) {
    EXPECT_EQ(single[i].response, all.responses[i]);
    EXPECT_NEAR(single[i].coherence[1],
                all.coherence(1, static_cast<Eigen::Index>(i)), 1e-12);
  }
}

}  // namespace
}  // namespace pinode
