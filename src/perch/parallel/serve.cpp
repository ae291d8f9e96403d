#include "perch/parallel/serve.hpp"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "perch/core/stopwatch.hpp"
#include "perch/parallel/portion.hpp"

namespace perch {
namespace {

struct Reply {
  Tag tag;
  Bytes bytes;
};

/// Does one job after the other on a thread of its own, while another looks after the messages.
class Workplace {
 public:
  Workplace(const Services& services, const Executor& executor, std::string name)
      : services_(services), executor_(executor), name_(std::move(name)), thread_([this] { run(); }) {}
  ~Workplace() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      jobs_.clear();
      if (stop_) stop_->cancel();
    }
    changed_.notify_one();
    thread_.join();
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  void add(Message job) {
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(std::move(job));
    }
    changed_.notify_one();
  }

  /// Portions of batches up to this one are answered as stopped.
  void stop(std::uint64_t batch) {
    const std::lock_guard lock(mutex_);
    stopped_ = std::max(stopped_, batch);
    if (stop_ && batch_ <= stopped_) stop_->cancel();
  }

  std::optional<Reply> reply() {
    const std::lock_guard lock(mutex_);
    if (replies_.empty()) return std::nullopt;
    Reply first = std::move(replies_.front());
    replies_.pop_front();
    return first;
  }

  bool busy() {
    const std::lock_guard lock(mutex_);
    return stop_ != nullptr || !jobs_.empty() || !replies_.empty();
  }

 private:
  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return closed_ || next() != jobs_.end(); });
      if (closed_) return;
      const auto place = next();
      const Message job = std::move(*place);
      jobs_.erase(place);
      stop_ = std::make_shared<StopCondition>();
      const std::shared_ptr<StopCondition> stop = stop_;
      batch_ = 0;
      if (job.tag == Tag::portion) {
        ByteReader from = job.read();
        batch_ = PortionHead::read(from).batch;
        if (batch_ <= stopped_) stop->cancel();
      }
      lock.unlock();
      std::optional<Reply> reply = job.tag == Tag::news ? hear(job, *stop) : work(job, *stop);
      lock.lock();
      if (reply) replies_.push_back(std::move(*reply));
      if (job.tag == Tag::news) ++heard_;
      stop_ = nullptr;
    }
  }

  /// What is told to all takes another way than portions do, and may come later than what builds on it.
  std::deque<Message>::iterator next() {
    if (jobs_.empty() || jobs_.front().tag == Tag::news) return jobs_.begin();
    ByteReader from = jobs_.front().read();
    if (PortionHead::read(from).news <= heard_) return jobs_.begin();
    return std::find_if(jobs_.begin(), jobs_.end(), [](const Message& job) { return job.tag == Tag::news; });
  }

  Service& service(const std::string& topic) const {
    const auto found = services_.find(topic);
    if (found == services_.end()) throw std::runtime_error("no service for " + topic);
    return *found->second;
  }

  template <typename Work>
  std::optional<Reply> reporting(std::uint64_t number, const Work& work) const {
    try {
      return work();
    } catch (const Interrupted&) {
      ByteWriter to;
      AnswersHead{number, false, 0.0}.write(to);
      return number == 0 ? std::nullopt : std::optional(Reply{Tag::answers, to.take()});
    } catch (...) {
      ByteWriter to;
      Failure::current(number, name_).write(to);
      return Reply{Tag::failure, to.take()};
    }
  }

  std::optional<Reply> hear(const Message& job, const StopCondition& stop) {
    return reporting(0, [&]() -> std::optional<Reply> {
      ByteReader from = job.read();
      Service& topic = service(from.text());
      topic.hear(from, executor_, stop);
      return std::nullopt;
    });
  }

  std::optional<Reply> work(const Message& job, const StopCondition& stop) {
    ByteReader from = job.read();
    const PortionHead head = PortionHead::read(from);
    return reporting(head.number, [&]() -> std::optional<Reply> {
      const Stopwatch watch;
      Service& topic = service(head.topic);
      if (head.has_common) {
        ByteReader common = from.part();
        topic.hear(common, executor_, stop);
      }
      std::vector<ByteReader> questions;
      for (std::uint64_t i = 0; i < head.items; ++i) questions.push_back(from.part());
      std::vector<ByteWriter> answers(questions.size());
      const auto answer = [&](std::size_t i, std::size_t worker) {
        topic.answer(questions[i], worker, stop, answers[i]);
      };
      bool complete = true;
      if (head.fills_process) {
        for (std::size_t i = 0; complete && i < questions.size(); ++i) {
          answer(i, 0);
          complete = !stop();
        }
      } else {
        complete = for_each_batched(executor_, questions.size(), head.grain, stop, answer) && !stop();
      }
      ByteWriter report, to;
      topic.report(report);
      AnswersHead{head.number, complete, watch.seconds()}.write(to);
      if (complete) {
        to.part(report.bytes());
        for (const ByteWriter& own : answers) to.part(own.bytes());
      }
      return Reply{Tag::answers, to.take()};
    });
  }

  const Services& services_;
  const Executor& executor_;
  const std::string name_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::deque<Message> jobs_;
  std::deque<Reply> replies_;
  std::shared_ptr<StopCondition> stop_;  ///< of the job that is being done
  std::uint64_t batch_ = 0;              ///< that it is of
  std::uint64_t stopped_ = 0, heard_ = 0;
  std::thread thread_;
};

/// News travel along a binomial tree: no process sends more than a few.
void pass_on(Transport& transport, const Message& news) {
  for (std::size_t step = 1; transport.rank() + step < transport.size(); step *= 2)
    if (step > transport.rank()) transport.send(transport.rank() + step, Tag::news, news.bytes);
}

}  // namespace

void serve(Transport& transport, const Services& services, const MakeExecutor& make_executor,
           const std::string& program) {
  std::unique_ptr<Executor> executor;
  std::optional<Workplace> workplace;
  // What waits longer is asked for more rarely: an answer that is late by less than a portion takes costs
  // nothing, since the next portion is there already.
  Backoff idle(Backoff::Duration(1000)), busy(Backoff::Duration(200));
  for (;;) {
    bool moved = false;
    if (workplace)
      while (auto reply = workplace->reply()) {
        transport.send(0, reply->tag, std::move(reply->bytes));
        moved = true;
      }
    if (auto message = transport.poll()) {
      moved = true;
      ByteReader from = message->read();
      if (message->tag == Tag::quit) break;
      if (message->tag == Tag::hello) {
        workplace.reset();
        executor = make_executor(from.count());
        workplace.emplace(services, *executor, transport.name());
        ByteWriter hello;
        hello.count(executor->workers());
        hello.text(program);
        hello.text(transport.name());
        transport.send(0, Tag::hello, hello.take());
      } else if (!workplace) {
        throw std::logic_error("a message came before the first process said hello");
      } else if (message->tag == Tag::stop) {
        workplace->stop(from.count());
      } else {
        if (message->tag == Tag::news) pass_on(transport, *message);
        workplace->add(std::move(*message));
      }
    }
    if (moved) {
      idle.reset();
      busy.reset();
    } else {
      (workplace && workplace->busy() ? busy : idle).wait();
    }
  }
  transport.flush();
}

void dismiss(Transport& transport) {
  const auto nothing = std::make_shared<const Bytes>();
  for (std::size_t p = 1; p < transport.size(); ++p) transport.send(p, Tag::quit, nothing);
  transport.flush();
}

}  // namespace perch
