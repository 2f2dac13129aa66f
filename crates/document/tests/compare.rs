//! Schemes side by side: the command, what it refuses, and what is shown.

use limn_document::{Document, Outcome};

fn open(text: &str) -> Document {
    let mut document = Document::new(1 << 30);
    for line in text.lines() {
        document.run(line).unwrap_or_else(|e| panic!("{line}: {e}"));
    }
    document
}

fn line(document: &Document) -> String {
    document
        .text()
        .lines()
        .filter(|l| l.starts_with("scheme") || l.starts_with("compare"))
        .collect::<Vec<_>>()
        .join("; ")
}

fn refusal(document: &mut Document, text: &str) -> String {
    let before = document.text();
    let error = document.run(text).unwrap_err().to_string();
    assert_eq!(document.text(), before, "{text} changes nothing");
    error
}

#[test]
fn schemes_stand_beside_the_present_one() {
    let mut document = open("open builtin:pawn\nscheme loop\nlevel 2");
    assert_eq!(document.panes().len(), 1);
    assert_eq!(document.run("compare butterfly w=0.05 sqrt3").unwrap(), Outcome::Refine);
    assert_eq!(document.run("compare butterfly w=0.05 sqrt3").unwrap(), Outcome::Nothing);
    let panes = document.panes();
    let shown: Vec<_> = panes.iter().map(|p| (p.plan.scheme.info.id, p.plan.level, p.refused.clone())).collect();
    assert_eq!(shown, [("loop", 2, None), ("butterfly", 2, None), ("sqrt3", 2, None)]);
    assert_eq!(panes[1].plan.params.get(0), Some(0.05));
    assert_eq!(panes[0].plan.rules, panes[2].plan.rules);
    assert_eq!(line(&document), "scheme loop; compare butterfly w=0.05 sqrt3");
    // The link brings it back.
    let mut again = Document::new(1 << 30);
    again.replay(&Document::from_link(&document.link()).unwrap()).unwrap();
    assert_eq!(again.text(), document.text());
    // Several commands in a line stay apart, and it is one step to undo.
    assert_eq!(document.undo_steps().0, Some("compare butterfly w=0.05 sqrt3"));
    document.run("undo").unwrap();
    assert_eq!(document.beside(), []);
    document.run("redo").unwrap();
    assert_eq!(document.beside().len(), 2);
    document.run("compare off").unwrap();
    assert_eq!(line(&document), "scheme loop");
    let all = limn_document::command::parse_script("compare butterfly w=0.05 sqrt3 level 3").unwrap();
    assert_eq!(all.len(), 2);
}

#[test]
fn what_cannot_be_compared_is_refused_in_a_sentence() {
    let mut document = open("open builtin:pawn\nscheme loop");
    let refuse = |document: &mut Document, text: &str| refusal(document, text);
    assert!(refuse(&mut document, "compare nothing").starts_with("there is no scheme `nothing`; there are "));
    assert_eq!(
        refuse(&mut document, "compare sqrt3 butterfly linear j-spline"),
        "compare shows up to 3 schemes beside the present one, not 4; leave some out"
    );
    let twice = "names butterfly twice, or it is the present scheme";
    assert!(refuse(&mut document, "compare butterfly butterfly").contains(twice));
    assert!(refuse(&mut document, "compare butterfly butterfly w=0.0625").contains(twice), "its default");
    assert!(refuse(&mut document, "compare loop").contains("or it is the present scheme"));
    assert_eq!(refuse(&mut document, "compare butterfly s=1"), "the scheme butterfly has no parameter `s`; it takes w");
    assert!(refuse(&mut document, "compare").contains("needs the id of a scheme"));
    assert!(refuse(&mut document, "compare off loop").contains("needs other arguments"));
    document.run("compare loop weights=warren butterfly butterfly w=0.05").unwrap();
    assert!(Document::new(1).run("compare loop").unwrap_err().to_string().contains("needs a model"));
}

#[test]
fn a_chosen_pane_changes_places_with_the_present_scheme() {
    let mut document = open("open builtin:pawn\nscheme loop\ncompare butterfly loop weights=warren");
    document.run("scheme butterfly").unwrap();
    assert_eq!(line(&document), "scheme butterfly; compare loop loop weights=warren");
    document.run("undo").unwrap();
    assert_eq!(line(&document), "scheme loop; compare butterfly loop weights=warren");
    document.run("scheme loop weights=warren").unwrap();
    assert_eq!(line(&document), "scheme loop weights=warren; compare butterfly loop");
    // A slider passes the other's value: that stays what it is, and has no word of its own while the two are one.
    document.run("compare butterfly").unwrap();
    document.run("scheme butterfly w=0.05").unwrap();
    document.run("compare butterfly").unwrap();
    document.drag("scheme butterfly w=0.0625").unwrap();
    assert_eq!((line(&document).as_str(), document.panes().len()), ("scheme butterfly", 2));
    document.drag("scheme butterfly w=0.07").unwrap();
    assert_eq!(line(&document), "scheme butterfly w=0.07; compare butterfly");
}

#[test]
fn panes_take_triangles_and_share_the_budget() {
    let mut document = open("open builtin:cube\nscheme catmull-clark\nlevel 3\ncompare loop doo-sabin");
    let panes = document.panes();
    assert_eq!(panes.iter().map(|p| p.triangulated).collect::<Vec<_>>(), [false, true, false]);
    assert!(panes[1].mesh.is_triangles() && panes[0].mesh.topology != panes[1].mesh.topology);
    assert!(std::sync::Arc::ptr_eq(&panes[0].mesh, &panes[2].mesh));
    // The first takes what it needs, the next of what is left, and the last says that it has no room.
    let need: Vec<u64> = panes.iter().map(|p| limn_mesh::predict(&p.mesh, &p.plan).unwrap().unwrap().bytes).collect();
    document.set_budget(need[0] + need[1] + need[2]);
    assert!(document.panes().iter().all(|p| p.refused.is_none()));
    document.set_budget(need[0] + need[1] + need[2] - 1);
    let panes = document.panes();
    assert_eq!(panes.iter().map(|p| p.refused.is_some()).collect::<Vec<_>>(), [false, false, true]);
    assert!(panes[2].refused.as_ref().unwrap().contains("choose level"), "{:?}", panes[2].refused);
    assert_eq!(panes[1].budget, need[1] + need[2] - 1);
    // No level is refused for another pane's sake.
    document.set_budget(need[0]);
    assert_eq!(document.highest_level(), 3);
    // A triangle scheme first: polygons for the others all the same.
    document.set_budget(1 << 30);
    document.run("scheme loop").unwrap();
    let panes = document.panes();
    assert_eq!(panes.iter().map(|p| p.mesh.is_triangles()).collect::<Vec<_>>(), [true, false, false]);
    assert_eq!(panes.iter().filter(|p| p.triangulated).count(), 0, "the report says it of the present scheme");
    assert_eq!(Document::compare_command(document.beside()), "compare catmull-clark doo-sabin");
    assert_eq!(Document::compare_command(&[]), "compare off");
}
