#include "pinode/estimate/shooting/segment_exchange.h"

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Reads from or writes to consecutive numbers: one order for both.
class Stream {
 public:
  Stream(double* at, bool writes) : at_(at), writes_(writes) {}

  template <typename Number>
  void Pass(Number* value) {
    if (writes_) {
      *at_ = static_cast<double>(*value);
    } else {
      *value = static_cast<Number>(*at_);
    }
    ++at_;
  }
  void Pass(Eigen::Index rows, Eigen::Index columns, Matrix* values) {
    const Eigen::Map<Matrix> there(at_, rows, columns);
    if (writes_) {
      CHECK_EQ(values->rows(), rows);
      CHECK_EQ(values->cols(), columns);
      Eigen::Map<Matrix>(at_, rows, columns) = *values;
    } else {
      *values = there;
    }
    at_ += rows * columns;
  }
  void Pass(Eigen::Ref<Vector> values) {
    if (writes_) {
      Eigen::Map<Vector>(at_, values.size()) = values;
    } else {
      values = Eigen::Map<const Vector>(at_, values.size());
    }
    at_ += values.size();
  }

 private:
  double* at_;
  bool writes_;
};

// Sizes of one record's results.
struct Shape {
  Eigen::Index channels = 0;
  Eigen::Index states = 0;
  Eigen::Index cross = 0;  // rows
  Eigen::Index end = 0;    // columns of the end's sensitivity
  Eigen::Index size() const {
    return 5 + channels + states * (2 + states + cross + end);
  }
};

Shape ShapeOf(const ShootingRecord& record, int num_free) {
  Shape shape;
  shape.channels = record.sigmas().size();
  shape.states = record.gaps().scales().size();
  if (record.HasFreeStarts()) shape.cross = num_free;
  if (record.num_segments() > 1) shape.end = shape.states + num_free;
  return shape;
}

void Pass(const Shape& shape, int segment, ShootingRecord* record, char* done,
          Stream* stream) {
  SegmentResult& result = record->results().of(segment);
  stream->Pass(done);
  stream->Pass(&result.ok);
  stream->Pass(&result.cost);
  stream->Pass(&result.failed_sample);
  stream->Pass(&result.failed_state);
  if (*done == 0 || !result.ok) return;
  result.squares.resize(shape.channels);
  stream->Pass(result.squares);
  stream->Pass(record->results().ends.col(segment));
  result.start_gradient.resize(shape.states);
  stream->Pass(result.start_gradient);
  stream->Pass(shape.states, shape.states, &result.start_hessian);
  if (shape.cross > 0) stream->Pass(shape.cross, shape.states, &result.cross);
  if (shape.end > 0) {
    stream->Pass(shape.states, shape.end, &result.end_sensitivity);
  }
}

}  // namespace

bool ExchangeSegments(
    const std::vector<std::unique_ptr<ShootingRecord>>& records,
    const std::vector<std::pair<int, int>>& segments,
    const std::vector<int>& owners, int num_free, Communicator* communicator,
    std::vector<char>* done) {
  if (communicator->size() == 1) return true;
  std::vector<Shape> shapes;
  for (const auto& record : records) {
    shapes.push_back(ShapeOf(*record, num_free));
  }
  const auto shape_of = [&](size_t t) -> const Shape& {
    return shapes[static_cast<size_t>(segments[t].first)];
  };
  // The numbers of rank after rank.
  const auto ranks = static_cast<size_t>(communicator->size());
  std::vector<int64_t> sizes(ranks, 0);
  for (size_t t = 0; t < segments.size(); ++t) {
    if (owners[t] < 0) continue;
    sizes[static_cast<size_t>(owners[t])] += shape_of(t).size();
  }
  std::vector<int64_t> begins(ranks, 0);
  for (size_t r = 1; r < ranks; ++r) begins[r] = begins[r - 1] + sizes[r - 1];
  Vector numbers = Vector::Zero(begins.back() + sizes.back());
  const auto pass = [&](bool writes) {
    std::vector<int64_t> at = begins;
    for (size_t t = 0; t < segments.size(); ++t) {
      if (owners[t] < 0) continue;
      int64_t& here = at[static_cast<size_t>(owners[t])];
      if (writes == (owners[t] == communicator->rank())) {
        Stream stream(numbers.data() + here, writes);
        Pass(shape_of(t), segments[t].second,
             records[static_cast<size_t>(segments[t].first)].get(), &(*done)[t],
             &stream);
      }
      here += shape_of(t).size();
    }
  };
  pass(true);
  if (!communicator->Gather(sizes, numbers.data())) return false;
  pass(false);
  return true;
}

}  // namespace pinode
