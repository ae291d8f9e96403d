#include "perch/parallel/team_executor.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/parallel/hand_out.hpp"
#include "perch/parallel/portion.hpp"

namespace perch {
namespace {

constexpr std::size_t portions_ahead = 2;  // at a process: one that it works on, one that waits there
constexpr double worth_sharing = 0.001;    // seconds that a batch would take here
constexpr Backoff::Duration longest_nap{100};

}  // namespace

struct TeamExecutor::Team {
  Team(Transport& transport_in, std::unique_ptr<Executor> own_in)
      : transport(transport_in), own(std::move(own_in)), workers(transport.size(), own->workers()) {}

  void send(std::size_t to, Tag tag, std::shared_ptr<const Bytes> bytes) {
    ++traffic.messages;
    traffic.bytes += bytes->size();
    transport.send(to, tag, std::move(bytes));
  }
  std::optional<Message> poll() {
    auto message = transport.poll();
    if (message) {
      ++traffic.messages;
      traffic.bytes += message->bytes->size();
    }
    return message;
  }

  Transport& transport;
  std::unique_ptr<Executor> own;
  std::vector<std::size_t> workers;   ///< of each process
  std::map<std::string, Pace> paces;  ///< by topic
  std::uint64_t batches = 0, portions = 0, news = 0;
  Traffic traffic;
};

namespace {

/// What is being worked on in other processes, and what was said of it.
struct Outstanding {
  std::size_t process = 0;
  std::vector<std::size_t> items;
};

}  // namespace

TeamExecutor::TeamExecutor(Transport& transport, std::unique_ptr<Executor> own, std::size_t threads,
                           const std::string& program)
    : team_(std::make_unique<Team>(transport, std::move(own))) {
  ByteWriter hello;
  hello.count(threads);
  for (std::size_t p = 1; p < processes(); ++p) transport.send(p, Tag::hello, hello.bytes());
  Backoff backoff(longest_nap);
  for (std::size_t missing = processes() - 1; missing > 0;) {
    if (const auto message = transport.poll()) {
      ByteReader from = message->read();
      team_->workers[message->from] = std::max<std::size_t>(1, from.count());
      if (const std::string other = from.text(); other != program)
        throw InputError(from.text() + " runs " + other + ", the first process " + program +
                         "; install the same program on all machines");
      --missing;
    } else {
      backoff.wait();
    }
  }
}

TeamExecutor::~TeamExecutor() = default;

std::size_t TeamExecutor::workers() const {
  return team_->own->workers();
}
const Executor& TeamExecutor::own() const {
  return *team_->own;
}
std::size_t TeamExecutor::processes() const {
  return team_->transport.size();
}
Traffic TeamExecutor::traffic() const {
  return team_->traffic;
}

bool TeamExecutor::for_each(std::size_t n, const Body& body, const StopCondition& stop) const {
  return team_->own->for_each(n, body, stop);
}

void TeamExecutor::tell(const std::string& topic, Bytes what) const {
  ByteWriter to;
  to.text(topic);
  to.raw(what.data(), what.size());
  ++team_->news;
  const auto bytes = std::make_shared<const Bytes>(to.take());
  for (std::size_t step = 1; step < processes(); step *= 2) {
    team_->traffic.news_bytes += bytes->size();
    team_->send(step, Tag::news, bytes);
  }
}

namespace {

/// One batch on its way through all processes.
class Spreading {
 public:
  Spreading(Batch& batch, const std::vector<std::size_t>& workers, Pace& pace, const Executor& own)
      : batch_(batch), pace_(pace), own_(own), hand_out_(batch, workers), has_common_(workers.size(), 0) {}

  /// Works on portions here until nothing is left or it is halted.
  void work_here() {
    try {
      for (;;) {
        const std::vector<std::size_t> items = take(0);
        if (items.empty() || halt_()) return;
        const Stopwatch watch;
        if (!work(items)) return;
        const std::lock_guard lock(mutex_);
        pace_.took(0, items.size(), watch.seconds());
        done_ += items.size();
      }
    } catch (const Interrupted&) {
      halt_.cancel();
    } catch (...) {
      fail();
    }
  }

  /// Halts for the exception that is being handled.
  void fail() {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::current_exception();
    halt_.cancel();
  }

  std::vector<std::size_t> take(std::size_t process) {
    const std::lock_guard lock(mutex_);
    return hand_out_.take(process, pace_);
  }

  Bytes portion(PortionHead head, std::size_t process, const std::vector<std::size_t>& items) {
    head.topic = batch_.topic();
    head.grain = batch_.grain();
    head.fills_process = batch_.fills_process();
    head.has_common = !has_common_[process];
    head.items = items.size();
    has_common_[process] = 1;
    ByteWriter to, question;
    head.write(to);
    if (head.has_common) {
      if (!common_) {
        batch_.write_common(question);
        common_ = question.take();
        question.clear();
      }
      to.part(*common_);
    }
    for (const std::size_t item : items) {
      question.clear();
      batch_.write_question(item, question);
      to.part(question.bytes());
    }
    return to.take();
  }

  void take_in(ByteReader from, double seconds, const Outstanding& portion) {
    ByteReader report = from.part();
    batch_.read_report(report);
    for (const std::size_t item : portion.items) {
      ByteReader answer = from.part();
      batch_.read_answer(item, answer);
    }
    const std::lock_guard lock(mutex_);
    pace_.took(portion.process, portion.items.size(), seconds);
    done_ += portion.items.size();
  }

  void halt() { halt_.cancel(); }
  void give_up() { batch_.give_up(); }
  bool halted() const { return halt_.cancelled(); }
  bool complete() const { return done_ == batch_.size(); }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  bool work(const std::vector<std::size_t>& items) {
    if (!batch_.fills_process())
      return for_each_batched(own_, items.size(), batch_.grain(), halt_,
                              [&](std::size_t i, std::size_t worker) { batch_.work(items[i], worker); });
    for (const std::size_t item : items) batch_.work(item, 0);
    return true;
  }

  Batch& batch_;
  Pace& pace_;
  const Executor& own_;
  std::mutex mutex_;  ///< of hand_out_, pace_, done_ and error_
  HandOut hand_out_;
  StopCondition halt_;
  std::size_t done_ = 0;
  std::exception_ptr error_;
  std::vector<char> has_common_;  ///< of each process
  std::optional<Bytes> common_;
};

}  // namespace

bool TeamExecutor::spread(Batch& batch, const StopCondition& stop) const {
  Team& team = *team_;
  Pace& pace = team.paces.try_emplace(batch.topic(), processes()).first->second;
  const double here = pace.items_a_second(0);
  if (processes() == 1 || batch.size() < 2 ||
      (here > 0.0 && static_cast<double>(batch.size()) < worth_sharing * here))
    return team.own->spread(batch, stop);

  const std::uint64_t number = ++team.batches;
  Spreading spreading(batch, team.workers, pace, *team.own);
  std::map<std::uint64_t, Outstanding> outstanding;
  std::vector<std::size_t> ahead(processes(), 0);
  std::optional<Failure> failure;
  const std::size_t most_ahead = batch.fills_process() ? 1 : portions_ahead;
  const auto hand_out_to = [&](std::size_t process) {
    while (ahead[process] < most_ahead && !spreading.halted()) {
      std::vector<std::size_t> items = spreading.take(process);
      if (items.empty()) return;
      PortionHead head;
      head.batch = number;
      head.number = ++team.portions;
      head.news = team.news;
      team.send(process, Tag::portion,
                std::make_shared<const Bytes>(spreading.portion(head, process, items)));
      team.traffic.items += items.size();
      outstanding[head.number] = {process, std::move(items)};
      ++ahead[process];
    }
  };
  const auto halt = [&] {
    spreading.give_up();
    ByteWriter to;
    to.count(number);
    const auto bytes = std::make_shared<const Bytes>(to.take());
    std::vector<char> told(processes(), 0);
    for (const auto& [portion, of] : outstanding)
      if (!std::exchange(told[of.process], 1)) team.send(of.process, Tag::stop, bytes);
  };

  // What goes wrong while others work must not leave them unheard.
  const auto guarded = [&](const auto& work) {
    try {
      work();
    } catch (...) {
      spreading.fail();
    }
  };

  guarded([&] {
    for (std::size_t p = 1; p < processes(); ++p) hand_out_to(p);
  });
  std::atomic<bool> here_done{false};
  std::thread worker([&] {
    spreading.work_here();
    here_done = true;
  });
  Backoff backoff(longest_nap);
  bool told_to_halt = false;
  while (!here_done || !outstanding.empty()) {
    if (stop()) spreading.halt();
    if (spreading.halted() && !std::exchange(told_to_halt, true)) halt();
    const auto message = team.poll();
    if (!message) {
      backoff.wait();
      continue;
    }
    backoff.reset();
    ByteReader from = message->read();
    std::uint64_t portion = 0;
    if (message->tag == Tag::failure) {
      failure = Failure::read(from);
      portion = failure->number;
      spreading.halt();
    } else {
      const AnswersHead head = AnswersHead::read(from);
      portion = head.number;
      if (head.complete && !failure)
        guarded([&] { spreading.take_in(from, head.seconds, outstanding.at(portion)); });
    }
    if (const auto found = outstanding.find(portion); found != outstanding.end()) {
      const std::size_t process = found->second.process;
      --ahead[process];
      outstanding.erase(found);
      guarded([&] { hand_out_to(process); });
    }
  }
  worker.join();
  spreading.rethrow();
  if (failure) failure->raise();
  return spreading.complete();
}

}  // namespace perch
