// Search for the vibrations of a free decay through its sampling rates.

#ifndef PINODE_MODAL_DECAY_SEARCH_H_
#define PINODE_MODAL_DECAY_SEARCH_H_

#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include "pinode/modal/decay_modes.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/mode_list.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/stabilisation_options.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Looks for the vibrations of a decay from the highest rate down. They are
// fitted together at the highest rate that has not too many samples; higher
// rates have a fit of their own, lower ones provide candidates. All arguments
// of the constructor must outlive this object.
class DecaySearch {
 public:
  DecaySearch(const ResponseRecord& record, const StabilisationOptions& options,
              ModesOfRecord* result, ModeList* modes)
      : record_(record), options_(options), result_(*result), modes_(*modes) {}

  // Takes the poles of a rate, lower than those before. Adds `band` to the
  // result.
  void Take(const RecordAtRate& level, std::vector<SubspacePole> poles,
            AnalysedBand band);
  // Fits the vibrations above `lowest_hz`, if there is a rate to be fitted.
  void Fit(double lowest_hz);

 private:
  // A rate at which vibrations are fitted.
  struct Job {
    RecordAtRate level;
    int band = 0;
    std::vector<SubspacePole> poles;
    std::vector<int> places;  // of the poles in the band
    std::vector<DecayTerm> terms;
    std::vector<std::complex<double>> candidates;  // from lower rates
    std::vector<std::complex<double>> picked;
  };

  void AddMembersOfLowerRates(int band, IdentifiedMode* mode,
                              std::vector<std::pair<int, int>>* members) const;
  bool IsListed(const PoleCluster& cluster);
  void RemarkOnRest(const Vector& rest);

  const ResponseRecord& record_;
  const StabilisationOptions& options_;
  ModesOfRecord& result_;
  ModeList& modes_;
  // Terms of higher rates as they are at the next rate.
  std::vector<DecayTerm> terms_;
  std::unique_ptr<Job> job_;
};

}  // namespace pinode

#endif  // PINODE_MODAL_DECAY_SEARCH_H_
