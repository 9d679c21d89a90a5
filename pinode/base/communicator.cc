#include "pinode/base/communicator.h"

namespace pinode {

bool Communicator::Sum(Vector* values) {
  return size() == 1 || Sum(values->data(), values->size());
}

bool Communicator::Broadcast(int root, Vector* values) {
  if (size() == 1) return true;
  int64_t count = values->size();
  if (!Broadcast(root, &count, sizeof(count))) return false;
  values->resize(count);
  return count == 0 || Broadcast(root, values->data(),
                                 count * static_cast<int64_t>(sizeof(double)));
}

bool Communicator::Broadcast(int root, std::string* text) {
  if (size() == 1) return true;
  auto count = static_cast<int64_t>(text->size());
  if (!Broadcast(root, &count, sizeof(count))) return false;
  text->resize(static_cast<size_t>(count));
  return count == 0 || Broadcast(root, text->data(), count);
}

bool Communicator::AllTrue(bool value) {
  double dissenters = value ? 0.0 : 1.0;
  return Sum(&dissenters, 1) && dissenters == 0.0;
}

Communicator& CommunicatorOrSingle(Communicator* communicator) {
  static SingleProcess single;
  return communicator != nullptr ? *communicator : single;
}

}  // namespace pinode
