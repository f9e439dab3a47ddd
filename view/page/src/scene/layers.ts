import { page } from "../page";

/** A layer that can be shown: its name, title, description and, if it has one, its colour in the theme. */
export const layers = [
  ["costMap", "Cost map", "where the rear axle would mean a collision, from the scan", "cost"],
  ["path", "Course line", "the line to follow", "path"],
  ["scan", "LiDAR", "end points of the scan", "scan"],
  ["candidates", "Candidates", "sampled control sequences, coloured by cost", undefined],
  ["guides", "Guides", "guide particles and how the solver moved them", "guide"],
  ["nominal", "Nominal", "the sequence around which samples are weighted", "nominal"],
  ["plan", "Plan", "the sequence that is sent to the car", "plan"],
  ["spread", "Spread", "two standard deviations of the plan, from the solver's covariance", "spread"],
  ["driven", "Driven line", "the path of the car", "driven"],
  ["obstacles", "Obstacles", "parked cars, boxes and poles", "obstacle"],
  ["opponents", "Opponents", "other cars; outlines and dots: where the planner expects them", "opponent"],
  ["modes", "Caption", "which way around the next obstacle the samples and the plan take", "nominal"],
  ["ghost", "Ghost", "the second controller, in a world of its own; as an outline, the best lap", "ghost"],
] as const;
export type Layer = (typeof layers)[number][0];

/** The terms of the cost, one of which colours the candidates; the last is the solver's cost. */
export const costTerms = () => [...(page.hello?.terms ?? ["distance", "yaw", "collision"]), "total"];
