/** One sample of a sonar; bin -1: the whole beam. */
export interface Sample {
  beam: number;
  bin: number;
}
