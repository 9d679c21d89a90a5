#include "pinode/network/network_json.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/network/initialize_weights.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

SavedNetwork Example() {
  SavedNetwork network;
  network.architecture.num_inputs = 2;
  network.architecture.num_outputs = 1;
  network.architecture.hidden_widths = {3, 2};
  network.architecture.activation = Activation::kLeakyRelu;
  network.architecture.bias = false;
  network.architecture.input_scale = Vector(2);
  network.architecture.input_scale << 0.1, 1.0 / 3.0;
  network.architecture.output_scale = Vector::Constant(1, 1.0 / 7.0);
  network.inputs = {"x[u1]", "d[ground,\"u\u00e9\"]"};
  network.outputs = {"u1"};
  network.weights = InitializeWeights(network.architecture, 3, false);
  network.weights[0] = -0.0;
  network.weights[1] = std::numeric_limits<double>::denorm_min();
  network.weights[2] = std::numeric_limits<double>::max();
  network.weights[3] = 3.0;
  return network;
}

void ExpectSame(const SavedNetwork& actual, const SavedNetwork& expected) {
  EXPECT_EQ(actual.inputs, expected.inputs);
  EXPECT_EQ(actual.outputs, expected.outputs);
  const NetworkArchitecture& a = actual.architecture;
  const NetworkArchitecture& b = expected.architecture;
  EXPECT_EQ(a.num_inputs, b.num_inputs);
  EXPECT_EQ(a.num_outputs, b.num_outputs);
  EXPECT_EQ(a.hidden_widths, b.hidden_widths);
  EXPECT_EQ(a.activation, b.activation);
  EXPECT_EQ(a.bias, b.bias);
  EXPECT_EQ(a.skip, b.skip);
  EXPECT_EQ(a.gauge, b.gauge);
  EXPECT_EQ(a.input_scale, b.input_scale);
  EXPECT_EQ(a.output_scale, b.output_scale);
  ASSERT_EQ(actual.weights.size(), expected.weights.size());
  for (int i = 0; i < expected.weights.size(); ++i) {
    EXPECT_EQ(actual.weights[i], expected.weights[i]) << i;
    EXPECT_EQ(std::signbit(actual.weights[i]),
              std::signbit(expected.weights[i]));
  }
}

TEST(NetworkJson, FileRoundTripIsExact) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("network.json");
  std::string error;
  const SavedNetwork network = Example();
  ASSERT_TRUE(WriteNetwork(path, network, &error)) << error;
  SavedNetwork read;
  ASSERT_TRUE(ReadNetwork(path, &read, &error)) << error;
  ExpectSame(read, network);
}

TEST(NetworkJson, RoundTripKeepsGaugeAndLinearNetworks) {
  SavedNetwork gauged = Example();
  gauged.architecture.skip = false;
  gauged.architecture.gauge = true;
  gauged.architecture.bias = true;
  gauged.weights = InitializeWeights(gauged.architecture, 4, false);
  SavedNetwork linear = Example();
  linear.architecture.hidden_widths = {};
  linear.weights = InitializeWeights(linear.architecture, 4, false);
  for (const SavedNetwork& network : {gauged, linear}) {
    std::string text;
    std::string error;
    ASSERT_TRUE(FormatNetwork(network, &text, &error)) << error;
    SavedNetwork read;
    ASSERT_TRUE(ParseNetwork(text, "n.json", &read, &error)) << error;
    ExpectSame(read, network);
  }
}

TEST(NetworkJson, MissingScaleIsWrittenAsOnes) {
  SavedNetwork network = Example();
  network.architecture.input_scale = Vector();
  network.architecture.output_scale = Vector();
  std::string text;
  std::string error;
  ASSERT_TRUE(FormatNetwork(network, &text, &error)) << error;
  SavedNetwork read;
  ASSERT_TRUE(ParseNetwork(text, "n.json", &read, &error)) << error;
  EXPECT_EQ(read.architecture.input_scale, Vector::Ones(2));
  EXPECT_EQ(read.architecture.output_scale, Vector::Ones(1));
}

constexpr char kGood[] = R"({
"schema": "pinode-network-1",
"inputs": ["x[u1]"],
"outputs": ["u1"],
"input_scale": [1.0],
"hidden_widths": [1],
"activation": "tanh",
"bias": true,
"skip": false,
"gauge": false,
"weights": [1, 2.5, -3, 4e-1]
})";

// Without output_scale, as files from before there was one.
TEST(NetworkJson, ReadsWhatAPersonWrote) {
  SavedNetwork network;
  std::string error;
  ASSERT_TRUE(ParseNetwork(kGood, "n.json", &network, &error)) << error;
  EXPECT_EQ(network.architecture.output_scale, Vector::Ones(1));
  EXPECT_EQ(network.weights, (Vector(4) << 1.0, 2.5, -3.0, 0.4).finished());
}

TEST(NetworkJson, BadFilesAreRefusedWithTheReason) {
  struct Case {
    const char* find;
    const char* replacement;
    const char* expected;
  };
  const Case kCases[] = {
      {"\"gauge\": false,", "\"gauge\": false", "n.json:11: not valid JSON"},
      {kGood, "", "n.json:1: not valid JSON"},
      {kGood, "[1, 2]", "not a JSON object"},
      {kGood, "{}", "no key schema with the value \"pinode-network-1\""},
      {"network-1", "network-2", "no key schema"},
      {"\"bias\": true,", "", "no key 'bias'"},
      {"\"bias\"", "\"biass\"", "unknown key 'biass'; did you mean 'bias'?"},
      {"\"bias\": true", "\"bias\": 1", "bias is 1, expected true or false"},
      {"\"tanh\"", "\"tahn\"",
       "unknown activation 'tahn'; did you mean 'tanh'?"},
      {"\"tanh\"", "[]", "activation is an array, expected a string"},
      {"[\"x[u1]\"]", "\"x[u1]\"", "inputs is \"x[u1]\", expected an array"},
      {"[\"x[u1]\"]", "[\"x[u1]\", 3]", "inputs[1] is 3, expected a string"},
      {"[\"x[u1]\"]", "[]", "num_inputs is 0"},
      {"[\"u1\"]", "[]", "num_outputs is 0"},
      {"[1.0]", "[0.0]", "input_scale[0]"},
      {"[1.0]", "[1.0, 2.0]", "input_scale has 2 entries"},
      {"[1]", "[1.5]", "hidden_widths[0] is 1.5"},
      {"[1]", "[-1]", "hidden_widths[0] is -1"},
      {"[1]", "[0]", "hidden_widths[0] is 0"},
      {"[1]", "[2]", "weights has 4 entries, expected 7"},
      {"[1]", "[2000000000]", "expected a smaller network"},
      {"[1]", "[99999999999999999999]", "hidden_widths[0] is 1e+20"},
      {"2.5", "null", "weights[1] is null, expected a finite number"},
      {"2.5", "\"2.5\"", "weights[1] is \"2.5\""},
      {"2.5", "NaN", "n.json:11: not valid JSON"},
      {"2.5", "1e999", "out of range"},
      {"\"gauge\": false", "\"gauge\": true", "weights has 4 entries"},
      {"\"skip\": false,\n\"gauge\": false", "\"skip\": true, \"gauge\": true",
       "gauge and skip are both true"},
  };
  for (const Case& c : kCases) {
    std::string text = kGood;
    const size_t at = text.find(c.find);
    ASSERT_NE(at, std::string::npos) << c.find;
    text.replace(at, std::string(c.find).size(), c.replacement);
    SavedNetwork network;
    network.inputs = {"untouched"};
    std::string error;
    EXPECT_FALSE(ParseNetwork(text, "n.json", &network, &error)) << text;
    EXPECT_THAT(error, StartsWith("n.json:"));
    EXPECT_THAT(error, HasSubstr(c.expected));
    EXPECT_EQ(network.inputs, std::vector<std::string>{"untouched"});
  }
}

TEST(NetworkJson, DeepNestingIsRefused) {
  std::string text = kGood;
  text.replace(text.find("2.5"), 3,
               std::string(1000000, '[') + std::string(1000000, ']'));
  SavedNetwork network;
  std::string error;
  EXPECT_FALSE(ParseNetwork(text, "n.json", &network, &error));
  EXPECT_THAT(error, HasSubstr("weights[1] is an array"));
}

TEST(NetworkJson, MissingFileIsNamed) {
  SavedNetwork network;
  std::string error;
  EXPECT_FALSE(ReadNetwork("/nonexistent/n.json", &network, &error));
  EXPECT_THAT(error, StartsWith("/nonexistent/n.json: "));
}

TEST(NetworkJson, InvalidNetworksAreNotWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("network.json");
  std::string error;
  SavedNetwork network = Example();
  network.weights[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(WriteNetwork(path, network, &error));
  EXPECT_THAT(error, HasSubstr(path + ": weights[4] is nan"));
  network = Example();
  network.outputs.push_back("u2");
  EXPECT_FALSE(WriteNetwork(path, network, &error));
  EXPECT_THAT(error, HasSubstr("outputs has 2 entries, expected 1"));
  network = Example();
  network.inputs[0] = "\xff";
  EXPECT_FALSE(WriteNetwork(path, network, &error));
  EXPECT_THAT(error, HasSubstr("UTF-8"));
  std::string text;
  EXPECT_FALSE(ReadTextFile(path, &text, &error)) << "a file was left";
}

}  // namespace
}  // namespace pinode
