#include "pinode/estimate/shooting/record_sums.h"

#include <utility>

#include "pinode/base/compensated_sum.h"

namespace pinode {
namespace {

// Calls each(column of `one`, column of `other`), of triangles what is filled.
template <typename Each>
void ForEachColumn(RecordSums* one, RecordSums* other, const Each& each) {
  each(one->costs, other->costs);
  each(one->end, other->end);
  for (Eigen::Index j = 0; j < one->products.cols(); ++j) {
    each(one->products.col(j), other->products.col(j));
  }
  const auto lower = [&](Matrix* own, Matrix* others) {
    for (Eigen::Index j = 0; j < own->cols(); ++j) {
      const Eigen::Index below = own->rows() - j;
      each(own->col(j).tail(below), others->col(j).tail(below));
    }
  };
  for (size_t p = 0; p < one->grams.size(); ++p) {
    lower(&one->grams[p], &other->grams[p]);
  }
  for (size_t h = 0; h < one->hessians.size(); ++h) {
    lower(&one->hessians[h], &other->hessians[h]);
  }
}

}  // namespace

void PieceSums::Close() {
  Add(&piece_);
  ForEachColumn(&piece_, &piece_, [](auto&& own, auto&&) { own.setZero(); });
}

void PieceSums::Add(PieceSums* other) {
  Add(&other->sum_);
  ForEachColumn(&rest_, &other->rest_,
                [](auto&& own, auto&& others) { own += others; });
}

RecordSums PieceSums::Take() {
  ForEachColumn(&sum_, &rest_, [](auto&& own, auto&& rest) { own += rest; });
  return std::move(sum_);
}

void PieceSums::Add(RecordSums* term) {
  // Columns of the three in their common order.
  std::vector<Eigen::Map<Vector>> rests;
  ForEachColumn(&rest_, &rest_, [&](auto&& own, auto&&) {
    rests.emplace_back(own.data(), own.size());
  });
  size_t at = 0;
  ForEachColumn(&sum_, term, [&](auto&& own, auto&& added) {
    AddCompensated(added, own, rests[at++]);
  });
}

}  // namespace pinode
