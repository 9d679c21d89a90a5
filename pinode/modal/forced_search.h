// Search for the modes of a record with measured loads through its sampling
// rates.

#ifndef PINODE_MODAL_FORCED_SEARCH_H_
#define PINODE_MODAL_FORCED_SEARCH_H_

#include <memory>
#include <utility>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/forced_fit.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/mode_list.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/stabilisation.h"
#include "pinode/modal/stabilisation_options.h"

namespace pinode {

// Takes the clusters of all rates, fits them together at the highest one, and
// lists those that the data need. All arguments of the constructor must outlive
// this object.
class ForcedSearch {
 public:
  ForcedSearch(const ResponseRecord& record,
               const StabilisationOptions& options, ModesOfRecord* result,
               ModeList* modes)
      : record_(record), options_(options), result_(*result), modes_(*modes) {}

  // Takes the clusters of a rate, lower than those before. `places` are those
  // of the poles in the band, as of AddPoles.
  void Take(const RecordAtRate& level, const AnalysedBand& band,
            const std::vector<PoleCluster>& clusters,
            const std::vector<int>& places, double window_seconds);
  // Lists the modes that the data need.
  void Fit(double lowest_hz);

 private:
  struct Candidate {
    PoleCluster cluster;
    ModeList::Entry entry;  // as subspace identification has it
    int max_order = 0;
  };

  void MergeCandidates();
  bool FitPoles(double lowest_hz);
  void AddUnfitted(const Candidate& candidate);
  void AddFitted(const SubspacePole& pole, const Candidate& candidate);

  const ResponseRecord& record_;
  const StabilisationOptions& options_;
  ModesOfRecord& result_;
  ModeList& modes_;
  std::unique_ptr<RecordAtRate> level_;  // of the highest rate
  std::vector<Candidate> candidates_;
};

}  // namespace pinode

#endif  // PINODE_MODAL_FORCED_SEARCH_H_
