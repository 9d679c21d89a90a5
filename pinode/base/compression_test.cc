#include "pinode/base/compression.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

std::string FromHex(const std::string& digits) {
  std::string bytes;
  for (size_t i = 0; i + 1 < digits.size(); i += 2) {
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  }
  return bytes;
}

// Python's gzip.compress(b"1 1 2.5\n", mtime=0) and zlib.compress of the same.
std::string GzipOfALine() {
  return FromHex("1f8b08000000000002033354305430d233e50200723e0ac708000000");
}
std::string ZlibOfALine() {
  return FromHex("789c3354305430d233e5020005fc0142");
}
// Python's gzip.compress of a million zeros.
std::string GzipOfZeros() {
  return FromHex("1f8b0800000000000203edc101010000008220ffaf6e484001") +
         std::string(968, '\0') + FromHex("af069ecb791240420f00");
}

constexpr size_t kLarge = 1 << 20;

TEST(CompressionTest, UnpacksWhatOthersPacked) {
  std::string text, what;
  ASSERT_TRUE(
      Unpack(CompressedFormat::kGzip, GzipOfALine(), kLarge, &text, &what))
      << what;
  EXPECT_EQ(text, "1 1 2.5\n");
  ASSERT_TRUE(
      Unpack(CompressedFormat::kZlib, ZlibOfALine(), kLarge, &text, &what))
      << what;
  EXPECT_EQ(text, "1 1 2.5\n");
  ASSERT_TRUE(
      Unpack(CompressedFormat::kGzip, GzipOfZeros(), kLarge, &text, &what))
      << what;
  EXPECT_EQ(text, std::string(1000000, '\0'));
}

TEST(CompressionTest, MembersOfGzipFollowEachOther) {
  std::string text, what;
  ASSERT_TRUE(Unpack(CompressedFormat::kGzip, GzipOfALine() + GzipOfALine(),
                     kLarge, &text, &what))
      << what;
  EXPECT_EQ(text, "1 1 2.5\n1 1 2.5\n");
}

TEST(CompressionTest, NothingLargerThanAllowed) {
  std::string text = "kept", what;
  ASSERT_TRUE(Unpack(CompressedFormat::kGzip, GzipOfALine(), 8, &text, &what))
      << what;
  text = "kept";
  EXPECT_FALSE(Unpack(CompressedFormat::kGzip, GzipOfALine(), 7, &text, &what));
  EXPECT_THAT(what, HasSubstr("more than 7 bytes"));
  EXPECT_FALSE(
      Unpack(CompressedFormat::kGzip, GzipOfZeros(), 999999, &text, &what));
  EXPECT_THAT(what, HasSubstr("more than 999999 bytes"));
  EXPECT_EQ(text, "kept");
}

TEST(CompressionTest, DamagedOrCutOff) {
  const std::string whole = GzipOfALine();
  std::string text = "kept", what;
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(Unpack(CompressedFormat::kGzip, whole.substr(0, length),
                        kLarge, &text, &what))
        << length;
    EXPECT_THAT(what, HasSubstr("damaged or cut off"));
  }
  // The checksum stands before the size in the last eight bytes.
  std::string other = whole;
  other[other.size() - 6] = static_cast<char>(other[other.size() - 6] + 1);
  EXPECT_FALSE(Unpack(CompressedFormat::kGzip, other, kLarge, &text, &what));
  EXPECT_FALSE(
      Unpack(CompressedFormat::kGzip, whole + "x", kLarge, &text, &what));
  EXPECT_FALSE(Unpack(CompressedFormat::kZlib, ZlibOfALine() + "x", kLarge,
                      &text, &what));
  EXPECT_FALSE(
      Unpack(CompressedFormat::kGzip, "1 1 2.5\n", kLarge, &text, &what));
  EXPECT_EQ(text, "kept");
}

}  // namespace
}  // namespace pinode
