#pragma once
#include <cstddef>
#include <vector>

namespace tendonlab {
/// First in, first out, in memory that is kept: a deque allocates every few times that a large item is pushed.
template <class T>
class Queue {
 public:
  bool empty() const { return first == items.size(); }
  std::size_t size() const { return items.size() - first; }
  const T& front() const { return items[first]; }
  const T& operator[](std::size_t i) const { return items[first + i]; }
  void push(const T& item) {
    if (2 * first > items.size()) items.erase(items.begin(), begin()), first = 0;
    items.push_back(item);
  }
  void pop() { ++first; }
  auto begin() const { return items.begin() + static_cast<std::ptrdiff_t>(first); }
  auto end() const { return items.end(); }

 private:
  std::vector<T> items;
  std::size_t first = 0;  ///< of those that are not popped
};
}  // namespace tendonlab
