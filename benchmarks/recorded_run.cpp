#include "recorded_run.hpp"

#include <utility>

namespace perch {
namespace {

/// Seconds that something takes.
template <typename Work>
double timed(const Work& work) {
  const ThreadStopwatch watch;
  work();
  return watch.seconds();
}

}  // namespace

void RecordingExecutor::tell(const std::string& topic, Bytes what) const {
  next_.before_news += watch_.seconds();
  next_.news_bytes += what.size();
  ByteReader from(what);
  next_.hear_news += timed([&] { services_.at(topic)->hear(from, own_, StopCondition()); });
  watch_ = Stopwatch();  // others hear it meanwhile
}

bool RecordingExecutor::spread(Batch& batch, const StopCondition& stop) const {
  next_.before += watch_.seconds();
  next_.topic = batch.topic();
  next_.grain = batch.grain();
  Service& service = *services_.at(batch.topic());
  ByteWriter common;
  batch.write_common(common);
  next_.common_bytes = common.size();
  ByteReader from(common.bytes());
  next_.hear_common = timed([&] { service.hear(from, own_, stop); });
  bool complete = true;
  for (std::size_t i = 0; complete && i < batch.size(); ++i) {
    RecordedBatch::Item item;
    item.home = batch.home(i);
    ByteWriter question, answer;
    item.write = timed([&] { batch.write_question(i, question); });
    ByteReader asked(question.bytes());
    item.answer = timed([&] { service.answer(asked, 0, stop, answer); });
    ByteReader answered(answer.bytes());
    item.read = timed([&] { batch.read_answer(i, answered); });
    item.question_bytes = static_cast<std::uint32_t>(question.size() + 1);
    item.answer_bytes = static_cast<std::uint32_t>(answer.size() + 1);
    next_.items.push_back(item);
    complete = !stop();
  }
  ByteWriter report;
  service.report(report);
  ByteReader reported(report.bytes());
  batch.read_report(reported);
  run_.batches.push_back(std::exchange(next_, {}));
  watch_ = Stopwatch();
  return complete;
}

RecordedRun RecordingExecutor::run() const {
  RecordedRun all = run_;
  all.after = next_.before + watch_.seconds();
  return all;
}

}  // namespace perch
