#include "pinode/estimate/shooting/ordered_sums.h"

#include <algorithm>
#include <numeric>

#include "pinode/estimate/shooting/residual_rows.h"

namespace pinode {
namespace {

// Groups that are added in one order, so that one, two and four ranks find the
// same digits.
constexpr int kGroups = 4;

// Adds the second of each pair to the first, then of each pair of pairs.
template <typename Add>
void AddInPairs(int count, const Add& add) {
  for (int step = 1; step < count; step *= 2) {
    for (int i = 0; i + step < count; i += 2 * step) add(i, i + step);
  }
}

// Lower triangle, column by column, and gradient.
void Pack(const FreeEquations& equations, Eigen::Ref<Vector> numbers) {
  Eigen::Index at = 0;
  const Eigen::Index free = equations.gradient.size();
  for (Eigen::Index j = 0; j < free; ++j) {
    numbers.segment(at, free - j) = equations.hessian.col(j).tail(free - j);
    at += free - j;
  }
  numbers.tail(free) = equations.gradient;
}

void Unpack(const Eigen::Ref<const Vector>& numbers, FreeEquations* equations) {
  Eigen::Index at = 0;
  const Eigen::Index free = equations->gradient.size();
  for (Eigen::Index j = 0; j < free; ++j) {
    equations->hessian.col(j).tail(free - j) = numbers.segment(at, free - j);
    at += free - j;
  }
  equations->gradient = numbers.tail(free);
}

}  // namespace

OrderedSums::OrderedSums(int num_free, int num_own, int num_threads,
                         Communicator* communicator)
    : communicator_(CommunicatorOrSingle(communicator)), num_free_(num_free) {
  const Eigen::Index size = WholeFours(Eigen::Index{num_own} + num_free + 1);
  const int ranks = communicator_.size();
  groups_ = ranks <= kGroups && kGroups % ranks == 0 ? kGroups : ranks;
  const int own = groups_ / ranks;
  const int threads = std::max(1, num_threads);
  parts_ = threads / std::gcd(threads, own);
  slots_.assign(static_cast<size_t>(own * parts_), Matrix::Zero(size, size));
  for (int task = 0; task < groups_ * parts_; ++task) {
    if (RankOf(task) == communicator_.rank()) order_.push_back(SlotOf(task));
  }
}

int OrderedSums::GroupOf(int task) const {
  const int group = task % groups_;
  // Groups that are added up first are a rank's: tasks that follow each other
  // are in groups that are added up last.
  return groups_ == kGroups ? group % 2 * 2 + group / 2 : group;
}

void OrderedSums::Clear() {
  for (Matrix& slot : slots_) slot.setZero();
}

int OrderedSums::SlotOf(int task) const {
  const int own = groups_ / communicator_.size();
  return GroupOf(task) % own * parts_ + task / groups_ % parts_;
}

bool OrderedSums::Total(FreeEquations* total) {
  AddInPairs(num_slots(), [this](int to, int from) { slot(to) += slot(from); });
  const Eigen::Index free = num_free_;
  const Eigen::Index last = slots_[0].rows() - 1;
  total->hessian = slots_[0].block(last - free, last - free, free, free);
  total->gradient = slots_[0].row(last).segment(last - free, free).transpose();
  const int ranks = communicator_.size();
  if (ranks == 1) return true;
  // Of few ranks each has a column of its own.
  const bool apart = groups_ > ranks || ranks <= 4;
  const Eigen::Index size = free * (free + 1) / 2 + free;
  Matrix sums = Matrix::Zero(size, apart ? ranks : 1);
  Pack(*total, sums.col(apart ? communicator_.rank() : 0));
  if (apart) {
    const std::vector<int64_t> sizes(static_cast<size_t>(ranks), size);
    if (!communicator_.Gather(sizes, sums.data())) return false;
  } else if (!communicator_.Sum(sums.data(), sums.size())) {
    return false;
  }
  AddInPairs(static_cast<int>(sums.cols()),
             [&sums](int to, int from) { sums.col(to) += sums.col(from); });
  Unpack(sums.col(0), total);
  return true;
}

}  // namespace pinode
