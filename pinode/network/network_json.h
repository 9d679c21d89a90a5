// Networks on disk.

#ifndef PINODE_NETWORK_NETWORK_JSON_H_
#define PINODE_NETWORK_NETWORK_JSON_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/network/network_architecture.h"

namespace pinode {

// A network with its weights and the names of what goes in and comes out.
struct SavedNetwork {
  NetworkArchitecture architecture;
  // As the case file spells them, such as "x[u1]" and "u1"; one for each input
  // and output.
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  // In the order of WeightLayout.
  Vector weights;

  // On failure *error says what is wrong and what was expected.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// {"schema": "pinode-network-1", "inputs": [...], "outputs": [...],
//  "input_scale": [...], "output_scale": [...], "hidden_widths": [...],
//  "activation": "tanh", "bias": true, "skip": true, "gauge": false,
//  "weights": [...]}
//
// Every key must be there, and no other, but output_scale, which older files
// lack and which is then ones. Numbers are written such that they are read back
// bit for bit; an empty scale is written as ones.
//
// Reading leaves *network untouched on failure, and *error reads
// `path[:line]: what, and what was expected`.
[[nodiscard]] bool ReadNetwork(const std::string& path, SavedNetwork* network,
                               std::string* error);

// Writes atomically. Fails on an invalid network, before touching the disk,
// and where the file cannot be written.
[[nodiscard]] bool WriteNetwork(const std::string& path,
                                const SavedNetwork& network,
                                std::string* error);

// The same without a file; `source` is named in the messages.
[[nodiscard]] bool ParseNetwork(const std::string& text,
                                const std::string& source,
                                SavedNetwork* network, std::string* error);
[[nodiscard]] bool FormatNetwork(const SavedNetwork& network, std::string* text,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_NETWORK_NETWORK_JSON_H_
