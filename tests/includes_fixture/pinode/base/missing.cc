// A source that tests/includes_test.py must refuse.

namespace pinode {

int Count(const std::vector<int>& values);

}  // namespace pinode
