#include "pinode/estimate/shooting/segment_cut.h"

#include "pinode/base/logging.h"

namespace pinode {

void SetSegments(Eigen::Index samples, const std::vector<Matrix>& trajectories,
                 MultipleShooting* shooting) {
  CHECK_EQ(trajectories.size(), shooting->train_records().size())
      << "one trajectory per training record";
  for (size_t r = 0; r < trajectories.size(); ++r) {
    CHECK_EQ(trajectories[r].cols(), shooting->record(r).grid().num_samples());
    CHECK_EQ(trajectories[r].rows(),
             shooting->sweep().problem().dynamics->num_states());
  }
  shooting->Cut(samples, [&trajectories](size_t r, Eigen::Index sample) {
    return Vector(trajectories[r].col(sample));
  });
}

void SetSegmentsAtRest(Eigen::Index samples, MultipleShooting* shooting) {
  const int num_states = shooting->sweep().problem().dynamics->num_states();
  shooting->Cut(samples, [num_states](size_t, Eigen::Index) {
    return Vector(Vector::Zero(num_states));
  });
}

bool IsSingleShooting(const MultipleShooting& shooting) {
  for (size_t r = 0; r < shooting.train_records().size(); ++r) {
    if (shooting.record(r).num_segments() != 1) return false;
  }
  return true;
}

bool HasFreeStarts(const MultipleShooting& shooting) {
  for (size_t r = 0; r < shooting.train_records().size(); ++r) {
    if (shooting.record(r).HasFreeStarts()) return true;
  }
  return false;
}

}  // namespace pinode
