// Reads and writes networks as JSON files.

#ifndef PINODE_NETWORK_NETWORK_JSON_H_
#define PINODE_NETWORK_NETWORK_JSON_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/network/network_architecture.h"

namespace pinode {

// A network with its weights and the names of its inputs and outputs.
struct SavedNetwork {
  NetworkArchitecture architecture;
  // Names as in the case file, such as "x[u1]" and "u1", one for each input and
  // output.
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  // Weights in the order of WeightLayout.
  Vector weights;

  // Checks the network. On failure *error says what is wrong and what was
  // expected.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Reads a network file:
//
// {"schema": "pinode-network-1", "inputs": [...], "outputs": [...],
//  "input_scale": [...], "output_scale": [...], "hidden_widths": [...],
//  "activation": "tanh", "bias": true, "skip": true, "gauge": false,
//  "weights": [...]}
//
// Every key is required and no other is allowed. Only output_scale may be
// missing, as in older files; it is then ones. Numbers are written so that they
// are read back bit for bit. An empty scale is written as ones.
//
// On failure *network is unchanged and *error is `path[:line]: error, expected
// ...`.
[[nodiscard]] bool ReadNetwork(const std::string& path, SavedNetwork* network,
                               std::string* error);

// Writes a network atomically. Fails on an invalid network, before touching the
// disk, and if the file cannot be written.
[[nodiscard]] bool WriteNetwork(const std::string& path,
                                const SavedNetwork& network,
                                std::string* error);

// Do the same without a file. `source` is the name in messages.
[[nodiscard]] bool ParseNetwork(const std::string& text,
                                const std::string& source,
                                SavedNetwork* network, std::string* error);
[[nodiscard]] bool FormatNetwork(const SavedNetwork& network, std::string* text,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_NETWORK_NETWORK_JSON_H_
