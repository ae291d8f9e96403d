#include "simulated_ranks.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <numeric>
#include <queue>
#include <vector>

#include "perch/parallel/hand_out.hpp"

namespace perch {
namespace {

constexpr double nap_of_first = 50e-6;     // s, lost by rank 0 before it sees an answer that it waits for
constexpr double nap_of_others = 100e-6;   // s, lost by another before it sends an answer
constexpr double handling = 5e-6;          // s, of a message by rank 0, beside what it holds
constexpr double worth_sharing = 0.001;    // s, as TeamExecutor has it
constexpr std::size_t portions_ahead = 2;  // as TeamExecutor has it
constexpr std::uint64_t head_bytes = 40;   // of a message

/// The batch as HandOut sees it.
class Shape final : public Batch {
 public:
  explicit Shape(const RecordedBatch& batch) : batch_(batch) {}
  std::size_t size() const override { return batch_.items.size(); }
  std::string topic() const override { return batch_.topic; }
  void work(std::size_t, std::size_t) override {}
  void write_question(std::size_t, ByteWriter&) const override {}
  void read_answer(std::size_t, ByteReader&) override {}
  double home(std::size_t item) const override { return batch_.items[item].home; }
  std::size_t grain() const override { return batch_.grain; }

 private:
  const RecordedBatch& batch_;
};

class Simulation {
 public:
  Simulation(const RecordedRun& run, std::size_t ranks, const Link& link)
      : run_(run), link_(link), ready_(ranks, 0.0), nic_in_(ranks, 0.0), nic_out_(ranks, 0.0) {}

  SimulatedRun all() {
    for (const RecordedBatch& batch : run_.batches) {
      now_ += batch.before_news;
      if (batch.news_bytes > 0) tell(batch);
      now_ += batch.before;
      share(batch);
    }
    result_.seconds = now_ + run_.after;
    return result_;
  }

 private:
  enum class Kind { portion_arrives, worked, answers_arrive, worked_here };
  struct Event {
    double time;
    std::uint64_t order;
    Kind kind;
    std::size_t rank, portion;
    bool operator>(const Event& other) const {
      return time != other.time ? time > other.time : order > other.order;
    }
  };
  struct Portion {
    std::vector<std::size_t> items;
    double taken = 0.0;  ///< to work on it
    std::uint64_t question_bytes = head_bytes, answer_bytes = head_bytes;
  };

  double sending(std::uint64_t bytes) const { return static_cast<double>(bytes) / link_.bandwidth; }

  /// Along a binomial tree; each rank then makes of it what it has to.
  void tell(const RecordedBatch& batch) {
    std::vector<double> at(ready_.size(), now_);
    for (std::size_t rank = 0; rank < at.size(); ++rank) {
      double leaves = at[rank];
      for (std::size_t step = 1; rank + step < at.size(); step *= 2)
        if (step > rank || rank == 0) {
          leaves += sending(batch.news_bytes);
          at[rank + step] = leaves + link_.latency + nap_of_others;
        }
      if (rank > 0) ready_[rank] = at[rank] + batch.hear_news;
    }
  }

  void post(double time, Kind kind, std::size_t rank, std::size_t portion) {
    events_.push({time, order_++, kind, rank, portion});
  }

  /// From one rank to another, from a time on; when it has arrived.
  double carry(double time, std::size_t from, std::size_t to, std::uint64_t bytes) {
    nic_out_[from] = std::max(nic_out_[from], time) + sending(bytes);
    nic_in_[to] = std::max(nic_in_[to] + sending(bytes), nic_out_[from]);
    ++result_.messages;
    result_.bytes += bytes;
    return nic_in_[to] + link_.latency;
  }

  std::size_t make_portion(const RecordedBatch& batch, std::vector<std::size_t> items) {
    Portion portion;
    for (const std::size_t i : items) {
      portion.taken += batch.items[i].answer;
      portion.question_bytes += batch.items[i].question_bytes;
      portion.answer_bytes += batch.items[i].answer_bytes;
    }
    portion.items = std::move(items);
    portions_.push_back(std::move(portion));
    return portions_.size() - 1;
  }

  void share(const RecordedBatch& batch) {
    const double whole = std::accumulate(batch.items.begin(), batch.items.end(), 0.0,
                                         [](double sum, const auto& item) { return sum + item.answer; });
    Pace& pace = paces_.try_emplace(batch.topic, ready_.size()).first->second;
    const double here = pace.items_a_second(0);
    if (ready_.size() == 1 || batch.items.size() < 2 ||
        (here > 0.0 && static_cast<double>(batch.items.size()) < worth_sharing * here)) {
      now_ += whole;
      return;
    }
    const Shape shape(batch);
    HandOut hand_out(shape, std::vector<std::size_t>(ready_.size(), 1));
    portions_.clear();
    std::vector<std::size_t> ahead(ready_.size(), 0);
    std::vector<std::deque<std::size_t>> waiting(ready_.size());
    std::vector<char> working(ready_.size(), 0), has_common(ready_.size(), 0);
    double dispatcher = now_;  // when rank 0's own thread for messages is free
    std::size_t open = 0;
    const auto hand_out_to = [&](std::size_t rank) {
      while (ahead[rank] < portions_ahead) {
        std::vector<std::size_t> items = hand_out.take(rank, pace);
        if (items.empty()) return;
        for (const std::size_t i : items) dispatcher += batch.items[i].write;
        dispatcher += handling;
        const std::size_t portion = make_portion(batch, std::move(items));
        std::uint64_t bytes = portions_[portion].question_bytes;
        if (!has_common[rank]) {
          bytes += batch.common_bytes;
          portions_[portion].taken += batch.hear_common;
          has_common[rank] = 1;
        }
        post(carry(dispatcher, 0, rank, bytes) + nap_of_others, Kind::portion_arrives, rank, portion);
        ++ahead[rank];
        ++open;
      }
    };
    const auto start = [&](std::size_t rank, double time) {
      if (working[rank] || waiting[rank].empty()) return;
      working[rank] = 1;
      const std::size_t portion = waiting[rank].front();
      waiting[rank].pop_front();
      post(std::max(time, ready_[rank]) + portions_[portion].taken, Kind::worked, rank, portion);
    };
    const auto work_here = [&](double time) {
      std::vector<std::size_t> items = hand_out.take(0, pace);
      if (items.empty()) return;
      const std::size_t portion = make_portion(batch, std::move(items));
      post(time + portions_[portion].taken, Kind::worked_here, 0, portion);
      ++open;
    };
    for (std::size_t rank = 1; rank < ready_.size(); ++rank) hand_out_to(rank);
    work_here(now_);
    double end = dispatcher;
    while (open > 0) {
      const Event event = events_.top();
      events_.pop();
      const Portion& portion = portions_[event.portion];
      if (event.kind == Kind::portion_arrives) {
        waiting[event.rank].push_back(event.portion);
        start(event.rank, event.time);
      } else if (event.kind == Kind::worked) {
        working[event.rank] = 0;
        post(carry(event.time + nap_of_others, event.rank, 0, portion.answer_bytes), Kind::answers_arrive,
             event.rank, event.portion);
        start(event.rank, event.time);
      } else if (event.kind == Kind::worked_here) {
        pace.took(0, portion.items.size(), portion.taken);
        --open;
        end = std::max(end, event.time);
        work_here(event.time);
      } else {
        dispatcher = std::max(dispatcher, event.time + nap_of_first) + handling;
        for (const std::size_t i : portion.items) dispatcher += batch.items[i].read;
        pace.took(event.rank, portion.items.size(), portion.taken);
        --open;
        --ahead[event.rank];
        end = std::max(end, dispatcher);
        hand_out_to(event.rank);
      }
    }
    now_ = std::max(end, dispatcher);
  }

  const RecordedRun& run_;
  const Link link_;
  double now_ = 0.0;
  std::vector<double> ready_;  ///< when each has heard the news
  std::vector<double> nic_in_, nic_out_;
  std::map<std::string, Pace> paces_;
  std::vector<Portion> portions_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t order_ = 0;
  SimulatedRun result_;
};

}  // namespace

SimulatedRun simulate_ranks(const RecordedRun& run, std::size_t ranks, const Link& link) {
  return Simulation(run, ranks, link).all();
}

ModelledRun model_ranks(const RecordedRun& run, std::size_t ranks, const Link& link) {
  ModelledRun model;
  const auto r = static_cast<double>(ranks);
  model.alone = run.after;
  for (const RecordedBatch& batch : run.batches) {
    model.alone += batch.before_news + batch.before;
    double work = 0.0, here = 0.0, bytes = 0.0;
    for (const RecordedBatch::Item& item : batch.items) {
      work += item.answer;
      here += item.write + item.read;
      bytes += item.question_bytes + item.answer_bytes;
    }
    if (ranks == 1 || work < worth_sharing) {
      model.alone += work;
      continue;
    }
    const auto n = static_cast<double>(batch.items.size());
    // Full portions, and those that are halved towards the end.
    const double portions =
        std::min(n, work / HandOut::portion_seconds + r * std::log2(std::max(2.0, n / r)));
    const double elsewhere = (r - 1.0) / r;
    const double at_rank0 = elsewhere * std::max(here + 2.0 * portions * handling, bytes / link.bandwidth);
    const double spread = work / r + batch.hear_common;
    (spread > at_rank0 ? model.shared : model.rank0) += std::max(spread, at_rank0);
    // The first questions, the last answers, and the last item of whoever is last.
    model.waiting += 2.0 * link.latency + nap_of_first + 2.0 * nap_of_others + work / n;
    if (batch.news_bytes > 0) {
      const double hops = std::ceil(std::log2(r));
      const double bringing = static_cast<double>(batch.news_bytes) / link.bandwidth;
      model.news +=
          std::max(0.0, hops * (bringing + link.latency + nap_of_others) + batch.hear_news - batch.before);
    }
  }
  return model;
}

}  // namespace perch
