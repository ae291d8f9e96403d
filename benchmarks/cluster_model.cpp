#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "perch/core/error.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/prepare.hpp"
#include "perch/localize/services.hpp"
#include "replayed_ranks.hpp"
#include "simulated_ranks.hpp"

// How long one localization would take on many ranks: by a formula, by a simulation of events, and, with
// ranks that sleep in place of working, by the program's own protocol. Run by script/cluster_model.
namespace perch {
namespace {

struct NamedLink {
  const char* name;
  Link link;
};

const std::vector<NamedLink> links{{"2 us, 10 GB/s", {2e-6, 1e10}},
                                   {"50 us, 1.25 GB/s", {50e-6, 1.25e9}},
                                   {"100 us, 125 MB/s", {100e-6, 1.25e8}},
                                   {"1 ms, 125 MB/s", {1e-3, 1.25e8}}};

RecordedRun record(const std::string& file, const Settings& settings) {
  const SerialExecutor serial;
  const Scene scene = prepare(read_scene(file), settings, serial);
  const Result plain = localize(scene, settings, serial, StopCondition());
  const RecordingExecutor recording(localization_services());
  const Result recorded = localize(scene, settings, recording, StopCondition());
  if (plain.search_cost != recorded.search_cost || plain.lower_bound != recorded.lower_bound ||
      !(plain.stats.work == recorded.stats.work))
    throw std::logic_error("the services answer otherwise than the program does itself");
  return recording.run();
}

/// Sums over the batches of a topic, or of all.
struct Sums {
  double work = 0.0, write = 0.0, read = 0.0;
  std::uint64_t questions = 0, answers = 0;  // bytes
  std::size_t batches = 0, items = 0;

  void add(const RecordedBatch& batch) {
    ++batches;
    items += batch.items.size();
    for (const RecordedBatch::Item& item : batch.items) {
      work += item.answer;
      write += item.write;
      read += item.read;
      questions += item.question_bytes;
      answers += item.answer_bytes;
    }
  }
  double each(double sum) const { return sum / static_cast<double>(std::max<std::size_t>(1, items)); }
};

void describe(const RecordedRun& run) {
  double alone = run.after;
  std::uint64_t news = 0;
  std::map<std::string, Sums> topics;
  for (const RecordedBatch& batch : run.batches) {
    alone += batch.before_news + batch.before;
    news += batch.news_bytes;
    topics[batch.topic].add(batch);
  }
  fmt::print("recorded: rank 0 alone {:.3f} s; told to all {:.1f} MB\n\n", alone,
             1e-6 * static_cast<double>(news));
  fmt::print(
      "| batches | items | work on one, us | rank 0 writes, us | takes in, us | question, bytes | answer, "
      "bytes |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n");
  for (const auto& [topic, sums] : topics)
    fmt::print("| {} of {} | {} | {:.0f} | {:.2f} | {:.2f} | {:.0f} | {:.0f} |\n", sums.batches, topic,
               sums.items, 1e6 * sums.each(sums.work), 1e6 * sums.each(sums.write),
               1e6 * sums.each(sums.read), sums.each(static_cast<double>(sums.questions)),
               sums.each(static_cast<double>(sums.answers)));
  fmt::print("\n");
}

void print_table(const RecordedRun& run) {
  fmt::print(
      "| link | ranks | simulated, s | formula, s | speed-up | efficiency | rank 0 alone, s | held up by "
      "rank 0, s | "
      "messages an item |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  std::size_t items = 0;
  for (const RecordedBatch& batch : run.batches) items += batch.items.size();
  for (const NamedLink& link : links) {
    const double one = simulate_ranks(run, 1, link.link).seconds;
    for (const std::size_t ranks : {4, 16, 64, 80, 256}) {
      const SimulatedRun simulated = simulate_ranks(run, ranks, link.link);
      const ModelledRun model = model_ranks(run, ranks, link.link);
      fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.1f} | {:.0f} % | {:.3f} | {:.3f} | {:.3f} |\n", link.name,
                 ranks, simulated.seconds, model.seconds(), one / simulated.seconds,
                 100.0 * one / simulated.seconds / static_cast<double>(ranks), model.alone, model.rank0,
                 static_cast<double>(simulated.messages) / static_cast<double>(items));
    }
  }
}

void print_replay(const RecordedRun& run) {
  fmt::print(
      "\n| link | ranks | by the program's protocol, s | simulated, s | messages | simulated |\n"
      "|---|---:|---:|---:|---:|---:|\n");
  for (const NamedLink& link : links)
    for (const std::size_t ranks : {4, 16}) {
      const SimulatedRun replayed = replay_ranks(run, ranks, link.link),
                         simulated = simulate_ranks(run, ranks, link.link);
      fmt::print("| {} | {} | {:.3f} | {:.3f} | {} | {} |\n", link.name, ranks, replayed.seconds,
                 simulated.seconds, replayed.messages, simulated.messages);
    }
}

}  // namespace
}  // namespace perch

int main(int argc, char** argv) {
  CLI::App app("How long one localization would take on many ranks", "perch_cluster_model");
  std::string scene;
  std::vector<std::string> assignments;
  app.add_option("scene", scene, "scene file")->required();
  app.add_option("--set", assignments, "key=value, as for perch localize");
  CLI11_PARSE(app, argc, argv);
  try {
    perch::Settings settings;
    for (const std::string& assignment : assignments) {
      const std::size_t at = assignment.find('=');
      perch::set_field(settings, assignment.substr(0, at),
                       at == std::string::npos ? "" : assignment.substr(at + 1));
    }
    const perch::RecordedRun run = perch::record(scene, settings);
    perch::describe(run);
    perch::print_table(run);
    perch::print_replay(run);
  } catch (const perch::InputError& error) {
    fmt::print(stderr, "perch_cluster_model: {}\n", error.what());
    return 2;
  }
  return 0;
}
