#include "perch/parallel/local_network.hpp"

#include <algorithm>
#include <deque>
#include <mutex>
#include <vector>

namespace perch {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace

struct LocalNetwork::State {
  /// What is on its way to a process.
  struct Mailbox {
    struct Letter {
      Clock::time_point arrival;
      Message message;
    };
    std::mutex mutex;
    std::deque<Letter> letters;  ///< by arrival
    Clock::time_point free;      ///< when the link has brought all before
  };

  State(std::size_t size, const Link& link_in) : link(link_in), boxes(size) {}
  Link link;
  std::vector<Mailbox> boxes;
  std::vector<std::unique_ptr<End>> ends;
};

class LocalNetwork::End final : public Transport {
 public:
  End(State& state, std::size_t rank) : state_(state), rank_(rank) {}

  std::size_t rank() const override { return rank_; }
  std::size_t size() const override { return state_.boxes.size(); }
  std::string name() const override { return "rank " + std::to_string(rank_); }
  using Transport::send;
  void send(std::size_t to, Tag tag, std::shared_ptr<const Bytes> bytes) override {
    const Clock::duration taken = seconds(static_cast<double>(bytes->size()) / state_.link.bandwidth);
    free_ = std::max(free_, Clock::now()) + taken;
    State::Mailbox& box = state_.boxes[to];
    const std::lock_guard lock(box.mutex);
    box.free = std::max(box.free + taken, free_);
    box.letters.push_back({box.free + seconds(state_.link.latency), {rank_, tag, std::move(bytes)}});
  }
  std::optional<Message> poll() override {
    State::Mailbox& box = state_.boxes[rank_];
    const std::lock_guard lock(box.mutex);
    if (box.letters.empty() || box.letters.front().arrival > Clock::now()) return std::nullopt;
    Message message = std::move(box.letters.front().message);
    box.letters.pop_front();
    return message;
  }
  void flush() override {}

 private:
  State& state_;
  const std::size_t rank_;
  Clock::time_point free_;  ///< when the link has taken all that was sent
};

LocalNetwork::LocalNetwork(std::size_t size, const Link& link) : state_(std::make_unique<State>(size, link)) {
  for (std::size_t rank = 0; rank < size; ++rank)
    state_->ends.push_back(std::make_unique<End>(*state_, rank));
}

LocalNetwork::~LocalNetwork() = default;

Transport& LocalNetwork::of(std::size_t rank) {
  return *state_->ends[rank];
}

}  // namespace perch
