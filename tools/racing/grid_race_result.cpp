#include "tools/racing/grid_race_job.hpp"

#include "json/json.hpp"
#include "tools/command_line/words.hpp"
#include "tools/terminal/text_table.hpp"

namespace slalom::tools {
namespace {

using evaluation::CarEnd;
using evaluation::CarResult;
using evaluation::ContactRate;
using evaluation::GridRaceResult;

/// A car over several races. Places and ends are those of races that were not interrupted.
struct CarSummary {
  int races = 0, wins = 0, places = 0;
  int finished = 0, walls = 0, timeouts = 0, overtakes = 0, overtaken = 0;
  double best_lap = std::numeric_limits<double>::quiet_NaN();
  ContactRate contacts;
};
template <class Visit>
void visit_figures(const CarSummary& car, Visit&& visit) {
  using evaluation::Figure;
  visit(car.races, Figure{"races", "", "races that were not interrupted"});
  visit(car.wins, Figure{"wins", "", "races that it won"});
  visit(static_cast<double>(car.places) / car.races, Figure{"mean_place", "", "mean place, from 1"});
  visit(car.finished, Figure{"finished", "", "races that it finished"});
  visit(car.walls, Figure{"walls", "", "races that a wall ended"});
  visit(car.timeouts, Figure{"timeouts", "", "races that it did not finish in time"});
  visit(car.best_lap, Figure{"best_lap", "s", "time of the best whole lap"});
  visit(car.overtakes, Figure{"overtakes", "", "cars that it overtook"});
  visit(car.overtaken, Figure{"overtaken", "", "times that it was overtaken"});
  evaluation::visit_figures(car.contacts, visit);
}

CarSummary car_summary(const GridRaces& races, int entry) {
  CarSummary summary{.contacts = evaluation::contact_rate(races.results, entry)};
  for (const GridRaceResult& race : races.results) {
    const CarResult& car = race.cars[static_cast<std::size_t>(entry)];
    summary.best_lap = std::fmin(summary.best_lap, car.best_lap());
    summary.overtakes += car.overtakes;
    summary.overtaken += car.overtaken;
    if (race.cancelled) continue;
    ++summary.races;
    summary.places += car.place + 1;
    summary.wins += car.place == 0 && car.end == CarEnd::finished;
    summary.finished += car.end == CarEnd::finished;
    summary.walls += car.end == CarEnd::wall;
    summary.timeouts += car.end == CarEnd::timeout;
  }
  return summary;
}

/// Describes how a race ended for a car.
std::string end_text(const CarResult& car) {
  if (car.end == CarEnd::wall) return car.contact_before ? "out: wall, after a contact" : "out: wall";
  return car.end == CarEnd::finished ? "" : std::string(evaluation::name(car.end));
}

std::string contacts_text(const ContactRate& rate) {
  if (rate.kilometres <= 0) return "-";
  return formatted("%.1f (%.1f to %.1f)", rate.per_100_km, rate.interval.low, rate.interval.high);
}

Json rate_json(const ContactRate& rate) {
  Json json = figures_json(rate);
  json["caused_per_100_km_ci"] = {rate.interval.low, rate.interval.high};
  return json;
}

Json standing_json(const CarResult& car, const std::string& name) {
  Json json{{"car", name}, {"end", std::string(evaluation::name(car.end))}};
  json.update(figures_json(car));
  if (car.end == CarEnd::wall)
    json["wall"] = {{"pose", {car.last.x, car.last.y, car.last.yaw}}, {"contact_before", car.contact_before}};
  return json;
}

Json one_race_json(const GridRaceResult& race, const std::vector<std::string>& names, int number) {
  const auto name_of = [&](int car) { return names[static_cast<std::size_t>(car)]; };
  Json json{{"race", number},
            {"seed", race.seed},
            {"interrupted", race.cancelled},
            {"time", race.time},
            {"standings", Json::array()},
            {"contacts", Json::array()},
            {"overtakes", Json::array()}};
  for (const int car : race.standings)
    json["standings"].push_back(standing_json(race.cars[static_cast<std::size_t>(car)], name_of(car)));
  for (const evaluation::CarContact& contact : race.contacts)
    json["contacts"].push_back({{"time", contact.time},
                                {"cars", Json::array({name_of(contact.cars[0]), name_of(contact.cars[1])})},
                                {"at_fault", name_of(contact.at_fault)},
                                {"pose", {contact.pose.x, contact.pose.y, contact.pose.yaw}}});
  for (const evaluation::Overtake& overtake : race.overtakes)
    json["overtakes"].push_back({{"time", overtake.time},
                                 {"car", name_of(overtake.car)},
                                 {"overtaken", name_of(overtake.overtaken)}});
  return json;
}

Json summary_json(const CarSummary& summary, const std::string& name) {
  const evaluation::Interval wins = evaluation::wilson_interval(summary.wins, summary.races);
  Json json{{"car", name}, {"win_rate_ci", {wins.low, wins.high}}};
  json.update(figures_json(summary));
  json["caused_per_100_km_ci"] = {summary.contacts.interval.low, summary.contacts.interval.high};
  return json;
}

}  // namespace

void print_standings(std::FILE* out, const std::vector<std::string>& names, const GridRaceResult& race) {
  std::fprintf(out, "\n");
  std::vector<std::string> heads = figure_heads({"<car"}, CarResult{});
  heads.emplace_back("<");
  TextTable table(std::move(heads));
  for (const int entry : race.standings) {
    const CarResult& car = race.cars[static_cast<std::size_t>(entry)];
    std::vector<std::string> row = figure_cells({names[static_cast<std::size_t>(entry)]}, car);
    row.push_back(end_text(car));
    table.add(std::move(row));
  }
  table.print(out);
  for (const evaluation::CarContact& contact : race.contacts)
    std::fprintf(out, "contact after %.2f s: %s and %s; %s at fault\n", contact.time,
                 names[static_cast<std::size_t>(contact.cars[0])].c_str(),
                 names[static_cast<std::size_t>(contact.cars[1])].c_str(),
                 names[static_cast<std::size_t>(contact.at_fault)].c_str());
}

void print_race_line(std::FILE* out, const std::vector<std::string>& names, const GridRaceResult& race,
                     int number) {
  std::fprintf(out, "race %d:", number);
  for (const int entry : race.standings) {
    const CarResult& car = race.cars[static_cast<std::size_t>(entry)];
    const std::string time = car.place == 0 ? formatted("%.2f s", car.time) : formatted("%+.2f s", car.gap);
    std::fprintf(out, "%s %s (%s)", car.place == 0 ? "" : ",", names[static_cast<std::size_t>(entry)].c_str(),
                 (car.end == CarEnd::finished ? time : end_text(car)).c_str());
  }
  std::fprintf(out, "; contacts: %zu, overtakes: %zu%s\n", race.contacts.size(), race.overtakes.size(),
               race.cancelled ? ", interrupted" : "");
  std::fflush(out);
}

void print_race_summary(std::FILE* out, const GridRaces& races) {
  std::fprintf(out, "\n");
  std::vector<std::string> heads = figure_heads({"<car"}, CarSummary{});
  heads.insert(heads.end(), {"<wins, % (95 %)", "<caused per 100 km (95 %)"});
  TextTable table(std::move(heads));
  for (std::size_t entry = 0; entry < races.names.size(); ++entry) {
    const CarSummary car = car_summary(races, static_cast<int>(entry));
    std::vector<std::string> row = figure_cells({races.names[entry]}, car);
    const std::optional share = static_cast<double>(car.wins) / car.races;
    row.insert(row.end(), {rate_cell(share, evaluation::wilson_interval(car.wins, car.races)),
                           contacts_text(car.contacts)});
    table.add(std::move(row));
  }
  table.print(out);
  const ContactRate all = evaluation::contact_rate(races.results);
  std::fprintf(out, "all cars: %d contacts in %.2f km, %s per 100 km\n", all.contacts, all.kilometres,
               contacts_text(all).c_str());
}

Json grid_races_json(const GridRaces& races) {
  Json json{{"races", Json::array()}, {"summary", {{"cars", Json::array()}}}};
  for (std::size_t i = 0; i < races.results.size(); ++i)
    json["races"].push_back(one_race_json(races.results[i], races.names, static_cast<int>(i) + 1));
  for (std::size_t entry = 0; entry < races.names.size(); ++entry)
    json["summary"]["cars"].push_back(
        summary_json(car_summary(races, static_cast<int>(entry)), races.names[entry]));
  json["summary"]["all"] = rate_json(evaluation::contact_rate(races.results));
  return json;
}

}  // namespace slalom::tools
