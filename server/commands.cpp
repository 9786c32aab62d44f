// SPDX-License-Identifier: Apache-2.0
#include "server/commands.h"

#include <CLI/CLI.hpp>

#include "server/cluster/copies.h"
#include "server/maintenance.h"

namespace kerf {

/// The commands for copies at NATS; --nats may precede or follow them.
void Commands::add_copies(CLI::App& app) {
  app.add_subcommand("copies", "lists the sessions whose journals are copied at NATS (--nats)")
      ->fallthrough();
  CLI::App* fetch = app.add_subcommand(
      "fetch", "writes the journal of a session from its copy at NATS (--nats), and verifies it");
  fetch->fallthrough();
  fetch->add_option("SESSION", session, "id of the session")->required();
  fetch->add_option("TO", fetched, "file to write, DATA/SESSION.kerf; no file is replaced")
      ->required();
  CLI::App* forget =
      app.add_subcommand("forget", "deletes the copy of a session's journal at NATS (--nats)");
  forget->fallthrough();
  forget->add_option("SESSION", session, "id of the session")->required();
}

void Commands::add_replay(CLI::App& app) {
  CLI::App* replay =
      app.add_subcommand("replay",
                         "carves a journal from the start and compares it with its state hashes "
                         "and its snapshots; exits with 1 at the first difference");
  replay->add_option("FILE", journal, "journal, DATA/SESSION.kerf")->required();
  replay
      ->add_option("--without-strokes", without_strokes,
                   "strokes, as GET .../strokes lists them, separated by commas: prints the hash "
                   "of the block in which they never happened, and compares nothing")
      ->delimiter(',');
}

void Commands::add_merge(CLI::App& app) {
  CLI::App* merge = app.add_subcommand(
      "merge",
      "writes a journal with all strokes of two copies of a block, or of two blocks of one scene; "
      "the block is the same in whichever order they are merged");
  merge->add_option("OURS", journal, "journal that stays first, .kerf")->required();
  merge->add_option("THEIRS", other, "journal whose strokes it lacks, .kerf")->required();
  merge->add_option("-o,--output", merged,
                    "journal to write; no file is replaced. Without it, lists the strokes of "
                    "THEIRS that OURS lacks");
  merge
      ->add_option("--strokes", strokes,
                   "takes only these strokes, as the list without --output names them, separated "
                   "by commas")
      ->delimiter(',');
}

void Commands::add(CLI::App& app) {
  app.add_subcommand("check",
                     "reads the journals and snapshots of a data folder; exits with 1 if "
                     "something is wrong, and says what to do")
      ->add_option("DATA", folder, "data folder, also of a running server")
      ->required();
  CLI::App* copy = app.add_subcommand(
      "backup",
      "copies the journals and the rights of a data folder into another folder, also while "
      "a server runs on it, and verifies the copies; exits with 1 if a journal is damaged");
  copy->add_option("DATA", folder, "data folder")->required();
  copy->add_option("TO", backup, "folder of the copies, created if missing; no file is replaced")
      ->required();
  add_replay(app);
  CLI::App* salvage = app.add_subcommand(
      "salvage",
      "writes what can be read of a damaged journal to a new one: the block of its newest good "
      "snapshot and the records after it, else the records before the damage; says what is lost");
  salvage->add_option("FILE", journal, "damaged journal, with its snapshots beside it; it stays")
      ->required();
  salvage->add_option("OUT", salvaged, "journal to write; no file is replaced")->required();
  add_merge(app);
  add_copies(app);
}

std::optional<int> Commands::run(const CLI::App& app, const std::string& nats) const {
  if (app.got_subcommand("copies")) return print_copies(nats);
  if (app.got_subcommand("fetch")) return fetch_journal(nats, session, fetched);
  if (app.got_subcommand("forget")) return forget_copy(nats, session);
  if (app.got_subcommand("check")) return check_data(folder);
  if (app.got_subcommand("backup")) return back_up(folder, backup);
  if (app.got_subcommand("salvage")) return salvage(journal, salvaged);
  if (app.got_subcommand("merge")) return merge(journal, other, merged, strokes);
  if (app.got_subcommand("replay")) {
    return without_strokes.empty() ? replay_journal(journal)
                                   : replay_without(journal, without_strokes);
  }
  return std::nullopt;
}

}  // namespace kerf
