/** Puts the page together. Records change the model; each frame draws the changes. */
import { Alarms } from './alarms';
import { Commands } from './commands';
import { Connection, toast } from './connection';
import { byId, mark, say } from './dom';
import { feedOf } from './feed';
import { settleInFrame } from './framed';
import { HealthView } from './health';
import { Instruments } from './instruments';
import { listenToKeys } from './keyboard';
import { Layout } from './layout';
import { Link } from './link';
import { DecisionLog } from './log';
import { Marks } from './marks';
import { Model } from './model';
import { ObstacleList } from './obstacle_list';
import { PlanView } from './plan/plan';
import { Planner } from './planner';
import { PlotsView } from './plots';
import { placeOf, Saving } from './saving';
import { SonarView } from './sonar/sonar';
import { SpaceView } from './space/space';
import './style.css';
import { Theme } from './theme';
import { Timeline } from './timeline';
import type { Shared, View } from './view';

const kTick = 250;

const model = new Model();
const feed = feedOf(document);
let waiting = false;
let broken = 0;
let shownRun = '';
let adopted: Marks | null = null;
const redraw = (): void => {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(draw);
};
const theme = new Theme(redraw);
const link = new Link((request) => feed.ask(request), {
  now: () => performance.now(),
  later: (ms, then) => void setTimeout(then, ms),
});
const shared: Shared = {
  model,
  theme,
  link,
  selected: null,
  redraw,
  ask(request) {
    if (!feed.ask(request)) toast('Not connected.');
  },
  wantVoxels: (all) => feed.ask({ ask: 'detail', voxels: all ? 'all' : 'cubes' }),
  showDecision(decision) {
    shared.selected = shared.selected?.number === decision.number ? null : decision;
    shared.obstacle = shared.selected?.obstacleNumber ?? null;
    if (shared.selected) plan.showDecision(decision);
    if (shared.selected && byId('plan').clientWidth === 0 && decision.way.length + (decision.obstacle ? 1 : 0) > 0)
      layout.show('plan');
    redraw();
  },
  pointedDecision: null,
  pointAt(decision) {
    shared.pointedDecision = decision;
    redraw();
  },
  obstacle: null,
  showObstacle(number) {
    shared.obstacle = shared.obstacle === number ? null : number;
    if (shared.obstacle !== null) plan.showObstacle(number);
    if (shared.obstacle !== null && byId('plan').clientWidth === 0) layout.show('plan');
    redraw();
  },
  hovered: null,
  hover(number) {
    shared.hovered = number;
    redraw();
  },
};

const layout = new Layout(redraw);
const plan = new PlanView(shared);
const planner = new Planner(shared, plan);
const sonar = new SonarView(shared);
const space = new SpaceView(shared);
const marks = new Marks(model);
const timeline = new Timeline(shared, marks);
const log = new DecisionLog(shared, (to) => timeline.seek(to));
const all: View[] = [
  new Instruments(shared),
  new Alarms(shared),
  plan,
  sonar,
  space,
  log,
  new ObstacleList(shared),
  new HealthView(shared),
  new PlotsView(shared, (to) => timeline.seek(to)),
  timeline,
  new Commands(shared, () => layout.show('health')),
  planner,
];
const connection = new Connection(shared, feed);
listenToKeys({ shared, layout, plan, space, timeline, theme });
settleInFrame();
new Saving(shared, plan);
const linked = placeOf(document.location.hash);

const switcher = byId<HTMLButtonElement>('theme');
const nameTheme = (): void => {
  say(switcher, theme.name === 'day' ? '☾ Night' : '☀ Day');
  switcher.setAttribute('aria-label', `Switch to ${theme.name === 'day' ? 'night' : 'day'} colours`);
};
switcher.addEventListener('click', () => theme.toggle());

/** Nothing that was chosen in one run is kept in another, as after a restart of the program. */
function begin(run: string): void {
  if (model.clock && linked.t !== undefined) {
    const { t } = linked;
    linked.t = undefined;
    plan.showSection(linked);
    if (t < model.clock.end - 1) timeline.seek(t);
  }
  if (run === '' || run === shownRun) return;
  if (shownRun !== '') {
    shared.selected = shared.pointedDecision = null;
    shared.obstacle = shared.hovered = null;
    plan.begin();
    planner.discard();
  }
  shownRun = run;
}

function draw(now: number): void {
  waiting = false;
  nameTheme();
  for (const view of all) {
    try {
      view.frame(now);
    } catch (error) {
      // A view that fails must not hide the alarms of the others.
      if (broken++ < 10) console.error(error);
    }
  }
  link.drew();
  connection.drew();
  mark(document.body, 'behind', String(all.some(({ behind }) => behind === true)));
}

feed.start(
  (records) => {
    model.take(records);
    begin(model.clock?.run ?? '');
    link.applied(model.clock);
    if (feed.marks && feed.marks !== adopted) marks.adopt((adopted = feed.marks));
    redraw();
  },
  () => {
    if (feed.state.is === 'connecting') link.forget();
    connection.tick(performance.now());
  },
);
window.setInterval(() => {
  connection.tick(performance.now());
  redraw();
}, kTick);
redraw();
